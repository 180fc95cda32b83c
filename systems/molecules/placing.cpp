#include "systems/molecules/placing.hpp"

namespace taut {
namespace {

constexpr int kTries = 200;          // for one copy at one width
constexpr double kNarrower = 0.9;    // from one width to the next, ...
constexpr double kNarrowest = 0.55;  // ... down to this: two atoms at half their σ

}  // namespace

std::optional<Vectors> Placing::put(const Conformations& conformations, const std::function<Vec3()>& where) {
  for (double width = 1; width > kNarrowest; width *= kNarrower)
    for (int attempt = 0; attempt < kTries; ++attempt)
      if (auto copy = conformations.put(where(), width, room_, random_)) return copy;
  return {};
}

void Placing::take(const Conformations& conformations, const Vectors& x, int each) {
  if (each == 0) each = conformations.atoms();
  for (Eigen::Index a = 0; a < x.cols(); ++a)
    room_.take(x.col(a), conformations.radius(static_cast<int>(a % each)));
}

std::vector<Eigen::Index> Placing::fitting(const Conformations& conformations, const Vectors& x,
                                           int each) const {
  std::vector<Eigen::Index> numbers;
  for (Eigen::Index m = 0; m < x.cols() / each; ++m) {
    bool free = true;
    for (int a = 0; free && a < each; ++a) free = room_.free(x.col(m * each + a), conformations.radius(a));
    if (free) numbers.push_back(m);
  }
  return numbers;
}

}  // namespace taut
