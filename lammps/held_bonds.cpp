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
  while (lower < count(i) && of(i)[lower].partner < atom_->tag[i]) ++lower;
  return lower;
}

void HeldBonds::assign(std::vector<std::vector<HeldBond>> held, int most, int room) {
  most_ = most;
  held_ = std::move(held);
  grow(room);
  for (auto& bonds : held_)
    std::sort(bonds.begin(), bonds.end(),
              [](const HeldBond& a, const HeldBond& b) { return a.partner < b.partner; });
}

int HeldBonds::pack(int i, double* buffer) const {
  double* next = buffer;
  *next++ = count(i);
  for (const HeldBond& bond : of(i)) {
    std::memcpy(next, &bond, kPacked * sizeof(double));
    next += kPacked;
  }
  return packed(i);
}

int HeldBonds::unpack(int i, const double* buffer) {
  const double* next = buffer;
  of(i).resize(static_cast<std::size_t>(*next++));
  for (HeldBond& bond : of(i)) {
    std::memcpy(static_cast<void*>(&bond), next, kPacked * sizeof(double));
    next += kPacked;
  }
  return packed(i);
}

void HeldBonds::unpack_past(int i, const double* buffer) {
  HeldBond known{};
  for (int n = 0; n < static_cast<int>(buffer[0]); ++n) {
    std::memcpy(static_cast<void*>(&known), buffer + 1 + n * kPacked, kPacked * sizeof(double));
    if (HeldBond* const bond = find(i, known.partner)) bond->past = known.past;
  }
}

double HeldBonds::memory_usage() const {
  std::size_t bytes = held_.capacity() * sizeof(held_[0]);
  for (const auto& bonds : held_) bytes += bonds.capacity() * sizeof(HeldBond);
  return static_cast<double>(bytes);
}

}  // namespace taut
