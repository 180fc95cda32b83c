#include "lammps/held_bonds.hpp"

#include <algorithm>
#include <cstring>

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
  buffer[0] = count_[i];
  std::memcpy(buffer + 1, of(i).data(), of(i).size_bytes());
  return packed(i);
}

int HeldBonds::unpack(int i, const double* buffer) {
  count_[i] = static_cast<int>(buffer[0]);
  std::memcpy(static_cast<void*>(of(i).data()), buffer + 1, of(i).size_bytes());
  return packed(i);
}

void HeldBonds::unpack_past(int i, const double* buffer) {
  std::vector<HeldBond> stored(static_cast<std::size_t>(buffer[0]));
  std::memcpy(static_cast<void*>(stored.data()), buffer + 1, stored.size() * sizeof(HeldBond));
  for (const HeldBond& known : stored)
    if (HeldBond* const bond = find(i, known.partner)) bond->past = known.past;
}

}  // namespace taut
