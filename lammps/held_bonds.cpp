#include "lammps/held_bonds.hpp"

#include <algorithm>

namespace taut {

HeldBond* HeldBonds::find(int i, LAMMPS_NS::tagint partner) {
  for (HeldBond& bond : of(i))
    if (bond.partner == partner) return &bond;
  return nullptr;
}

int HeldBonds::first_upward(int i) const {
  int lower = 0;
  while (lower < count_[i] && of(i)[lower].partner < atom_->tag[i]) ++lower;
  return lower;
}

void HeldBonds::assign(const std::vector<std::vector<HeldBond>>& held, int most, int room) {
  most_ = most;
  count_.clear();
  held_.clear();
  grow(std::max<int>(room, static_cast<int>(held.size())));
  for (std::size_t i = 0; i < held.size(); ++i) {
    count_[i] = static_cast<int>(held[i].size());
    std::copy(held[i].begin(), held[i].end(), of(static_cast<int>(i)).begin());
    std::sort(of(static_cast<int>(i)).begin(), of(static_cast<int>(i)).end(),
              [](const HeldBond& a, const HeldBond& b) { return a.partner < b.partner; });
  }
}

void HeldBonds::grow(int room) {
  count_.resize(std::max<std::size_t>(count_.size(), room));
  held_.resize(count_.size() * most_);
}

void HeldBonds::copy(int from, int to) {
  count_[to] = count_[from];
  std::ranges::copy(of(from), of(to).begin());
}

int HeldBonds::pack(int i, double* buffer) const {
  double* next = buffer;
  *next++ = count_[i];
  for (const auto& [partner, kind, past] : of(i)) {
    *next++ = static_cast<double>(partner);
    for (int type : {kind.bond, kind.other_bond, kind.angle}) *next++ = type;
    next = std::copy(past.begin(), past.end(), next);
  }
  return static_cast<int>(next - buffer);
}

int HeldBonds::unpack(int i, const double* buffer) {
  const double* next = buffer;
  count_[i] = static_cast<int>(*next++);
  for (auto& [partner, kind, past] : of(i)) {
    partner = static_cast<LAMMPS_NS::tagint>(*next++);
    for (int* type : {&kind.bond, &kind.other_bond, &kind.angle}) *type = static_cast<int>(*next++);
    std::copy_n(next, past.size(), past.begin());
    next += past.size();
  }
  return static_cast<int>(next - buffer);
}

void HeldBonds::unpack_past(int i, const double* buffer) {
  const int count = static_cast<int>(*buffer++);
  for (int k = 0; k < count; ++k, buffer += kPacked)
    if (HeldBond* const bond = find(i, static_cast<LAMMPS_NS::tagint>(buffer[0])))
      std::copy_n(buffer + 4, bond->past.size(), bond->past.begin());
}

}  // namespace taut
