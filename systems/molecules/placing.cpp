#include "systems/molecules/placing.hpp"

namespace taut {
namespace {

constexpr int kTries = 200;  // for one copy at one scale of its spheres
constexpr int kTriesBeforeOverlap = 20;
constexpr double kAnywhere = -1e9;   // scale of spheres that overlap all others
constexpr double kNarrower = 0.9;    // factor from one scale to the next, ...
constexpr double kNarrowest = 0.55;  // ... down to this: two atoms at half their σ

}  // namespace

std::optional<Vectors> Placing::place_copy(const Conformations& conformations,
                                           const std::function<Vec3()>& where) {
  for (double width = 1; width > kNarrowest; width *= kNarrower)
    for (int attempt = 0; attempt < (may_overlap_ ? kTriesBeforeOverlap : kTries); ++attempt)
      if (auto copy = conformations.place_copy(where(), width, space_, random_)) return copy;
  for (int attempt = 0; may_overlap_ && attempt < kTries; ++attempt)
    if (auto copy = conformations.place_copy(where(), kAnywhere, space_, random_)) return copy;
  return {};
}

void Placing::add_copies(const Conformations& conformations, const Vectors& x, int each) {
  if (each == 0) each = conformations.atoms();
  for (Eigen::Index a = 0; a < x.cols(); ++a)
    space_.add(x.col(a), conformations.radius(static_cast<int>(a % each)));
}

std::vector<Eigen::Index> Placing::list_fitting(const Conformations& conformations, const Vectors& x,
                                                int each) const {
  std::vector<Eigen::Index> numbers;
  for (Eigen::Index m = 0; m < x.cols() / each; ++m) {
    bool free = true;
    for (int a = 0; free && a < each; ++a)
      free = space_.is_between_walls(x.col(m * each + a)) &&
             space_.is_free(x.col(m * each + a), conformations.radius(a));
    if (free) numbers.push_back(m);
  }
  return numbers;
}

}  // namespace taut
