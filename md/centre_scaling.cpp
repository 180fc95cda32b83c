#include "md/centre_scaling.hpp"

#include <algorithm>
#include <numeric>

namespace taut {

CentreScaling::CentreScaling(const System& sys, const std::vector<int>& group) {
  const int groups = group.empty() ? 0 : *std::max_element(group.begin(), group.end()) + 1;
  begin_.assign(groups + 1, 0);
  mass_.assign(groups, 0);
  for (int a = 0; a < sys.atoms(); ++a) {
    ++begin_[group[a] + 1];
    mass_[group[a]] += sys.mass[a];
  }
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  std::vector<int> next(begin_.begin(), begin_.end() - 1);
  atom_.resize(group.size());
  share_.resize(group.size());
  for (int a = 0; a < sys.atoms(); ++a) {
    const int at = next[group[a]]++;
    atom_[at] = a;
    share_[at] = sys.mass[a] / mass_[group[a]];
  }
}

Vec3 CentreScaling::centre(int group, const Vectors& of) const {
  Vec3 sum = Vec3::Zero();
  for (int k = begin_[group]; k < begin_[group + 1]; ++k) sum += share_[k] * of.col(atom_[k]);
  return sum;
}

void CentreScaling::scale(const Vec3& by, Vectors& of, Atoms which) const {
  for (int g = 0; g < groups(); ++g) {
    const Vec3 shift = (by.array() - 1).matrix().cwiseProduct(centre(g, of));
    for (int k = begin_[g]; k < begin_[g + 1]; ++k)
      if (which == Atoms::kAll || share_[k] > 0) of.col(atom_[k]) += shift;
  }
}

void CentreScaling::scale_positions(const Vec3& mu, Vectors& x) const {
  scale(mu, x, Atoms::kAll);
}
void CentreScaling::scale_velocities(const Vec3& mu, Vectors& v) const {
  scale(mu.cwiseInverse(), v, Atoms::kOfMass);
}

Vec3 CentreScaling::twice_kinetic(const Vectors& v) const {
  Vec3 sum = Vec3::Zero();
  for (int g = 0; g < groups(); ++g) sum += mass_[g] * centre(g, v).cwiseAbs2();
  return sum;
}

Vec3 CentreScaling::twice_kinetic(const Vectors& v, double time, const Vectors& f) const {
  Vec3 sum = Vec3::Zero();
  for (int g = 0; g < groups(); ++g) {
    Vec3 momentum = mass_[g] * centre(g, v);
    for (int k = begin_[g]; k < begin_[g + 1]; ++k)
      if (share_[k] > 0) momentum += time * f.col(atom_[k]);
    sum += momentum.cwiseAbs2() / mass_[g];
  }
  return sum;
}

Vec3 CentreScaling::inner_virial(const Vectors& x, const Vectors& f) const {
  Vec3 sum = Vec3::Zero();
  for (int g = 0; g < groups(); ++g) {
    const Vec3 X = centre(g, x);
    for (int k = begin_[g]; k < begin_[g + 1]; ++k)
      sum += (x.col(atom_[k]) - X).cwiseProduct(f.col(atom_[k]));
  }
  return sum;
}

}  // namespace taut
