#include "forcefield/ewald/fourier.hpp"

#include <algorithm>
#include <numbers>

namespace taut {
namespace {

constexpr int kWhole = 8;        // numbers a row: all rows are aligned alike
constexpr int kLeastWidth = 32;  // numbers a row: 16 pairs, as many as the widest vector has lanes

int whole(int n, int of) {
  return (n + of - 1) / of * of;
}

// The largest first, for fewest passes over the numbers. There are two stages at least, since numbers go from memory to
// scratch and back.
std::vector<int> radices_of(int length) {
  std::vector<int> radices;
  for (const int radix : {8, 9, 6, 4, 2})
    for (; length % radix == 0; length /= radix) radices.push_back(radix);
  for (int radix = 3; length > 1; radix += 2)
    for (; length % radix == 0; length /= radix) radices.push_back(radix);
  while (radices.size() < 2) radices.push_back(1);
  return radices;
}

}  // namespace

template <class T>
FourierPlan<T>::FourierPlan(int length) : length_(length) {
  const auto root = [](long numerator, int n) {
    return std::complex<T>(std::polar(1.0, -2 * std::numbers::pi * static_cast<double>(numerator % n) / n));
  };
  int left = length;
  for (const int radix : radices_of(length)) {
    Stage stage{radix, left / radix, {}, {}};
    for (int k = 0; k < radix; ++k) stage.roots.push_back(root(k, radix));
    for (int p = 0; p < stage.rest; ++p)
      for (int j = 1; j < radix; ++j) stage.turned.push_back(root(long{j} * p, left));
    left = stage.rest;
    stages_.push_back(std::move(stage));
  }
}

template <class T>
FourierGrid<T>::FourierGrid(std::array<int, 3> size, int beyond)
    : n_(size),
      width_(std::max(whole(size[2], kWhole), kLeastWidth)),
      stride_(std::max(whole(size[2] + beyond, kWhole), width_)),
      rows_(size[1] + beyond),
      plan_{FourierPlan<T>(size[0]), FourierPlan<T>(size[1]), FourierPlan<T>(size[2])},
      real_(n_[0] * apart()),
      complex_(std::size_t(n_[0]) * half() * width_) {
  make_room(1);
}

template <class T>
void FourierGrid<T>::make_room(int threads) {
  const std::size_t row = std::size_t(n_[0]) * n_[2], plane = std::size_t(n_[1]) * pairs();
  std::size_t scratch = 0;
  for (const auto& plan : plan_) scratch = std::max(scratch, plan.scratch());
  while (static_cast<int>(room_.size()) < threads)
    room_.push_back({Aligned<Complex>(std::max(row, plane)), Aligned<Complex>(row), Aligned<T>(scratch)});
}

template <class T>
void FourierGrid<T>::transform_plane(int k1, int thread) {
  Room& room = room_[thread];
  transform_sequences(plan_[1], Direction::kForward, along_second(k1), {room.one.data(), pairs()}, pairs(),
                      room.scratch.data());
  for (int k2 = 0; k2 < half(); ++k2)
    separate_pairs(pairs_of(k2, room), pairs_of(-k2, room), pairs(), row(k1, k2));
}

template <class T>
void FourierGrid<T>::transform_plane_back(int k1, int thread) {
  Room& room = room_[thread];
  for (int k2 = 0; k2 < half(); ++k2)
    join_pairs(row(k1, k2), pairs(), pairs_of(k2, room), pairs_of(-k2, room));
  transform_sequences(plan_[1], Direction::kBackward, {room.one.data(), pairs()}, along_second(k1), pairs(),
                      room.scratch.data());
}

template <class T>
auto FourierGrid<T>::transform_row(int k2, int thread) -> Complex* {
  Room& room = room_[thread];
  transform_sequences(plan_[0], Direction::kForward, along_first(k2), {room.one.data(), n_[2]}, n_[2],
                      room.scratch.data());
  transform_sequences(plan_[2], Direction::kForward, {room.one.data(), n_[2], Layout::kInTurn},
                      {room.other.data(), n_[0]}, n_[0], room.scratch.data());
  return room.other.data();
}

template <class T>
void FourierGrid<T>::transform_row_back(int k2, int thread) {
  Room& room = room_[thread];
  transform_sequences(plan_[2], Direction::kBackward, {room.other.data(), n_[0]},
                      {room.one.data(), n_[2], Layout::kInTurn}, n_[0], room.scratch.data());
  transform_sequences(plan_[0], Direction::kBackward, {room.one.data(), n_[2]}, along_first(k2), n_[2],
                      room.scratch.data());
}

template class FourierPlan<double>;
template class FourierPlan<float>;
template class FourierGrid<double>;
template class FourierGrid<float>;

}  // namespace taut
