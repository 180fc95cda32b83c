#include "constraints/direct_solver.hpp"

namespace taut {

Couplings::Couplings(const System& sys) : reduced_inv_mass(sys.bond_count()) {
  std::vector<std::vector<int>> bonds_at(sys.atoms());
  for (int k = 0; k < sys.bond_count(); ++k) {
    const auto& [i, j, d] = sys.bonds[k];
    bonds_at[i].push_back(k);
    bonds_at[j].push_back(k);
    reduced_inv_mass[k] = sys.inv_mass[i] + sys.inv_mass[j];
  }
  for (int a = 0; a < sys.atoms(); ++a) {
    if (sys.inv_mass[a] == 0) continue;
    for (std::size_t p = 0; p < bonds_at[a].size(); ++p)
      for (std::size_t q = p + 1; q < bonds_at[a].size(); ++q) {
        const int k = bonds_at[a][p], l = bonds_at[a][q];
        const bool same_end = (sys.bonds[k].i == a) == (sys.bonds[l].i == a);
        pairs.push_back({k, l});
        signed_inv_mass.push_back(same_end ? sys.inv_mass[a] : -sys.inv_mass[a]);
      }
  }
}

DirectSolver::DirectSolver(const System& sys)
    : couplings_(sys),
      ldlt_(sys.bond_count(), couplings_.pairs),
      diagonal_(sys.bond_count()),
      values_(couplings_.pairs.size()) {}

void DirectSolver::factor(const Vectors& r, double threshold) {
  diagonal_ = couplings_.reduced_inv_mass.array() * r.colwise().squaredNorm().transpose().array();
  for (std::size_t e = 0; e < couplings_.pairs.size(); ++e) {
    const auto [k, l] = couplings_.pairs[e];
    values_[e] = couplings_.signed_inv_mass[e] * r.col(k).dot(r.col(l));
  }
  ldlt_.factor(diagonal_, values_, threshold);
}

UnsymmetricSolver::UnsymmetricSolver(const System& sys)
    : couplings_(sys),
      ldu_(sys.bond_count(), couplings_.pairs),
      diagonal_(sys.bond_count()),
      values_(couplings_.pairs.size()),
      mirrored_(values_.size()) {}

void UnsymmetricSolver::factor(const Vectors& r_new, const Vectors& r) {
  diagonal_ = couplings_.reduced_inv_mass.array() * r_new.cwiseProduct(r).colwise().sum().transpose().array();
  for (std::size_t e = 0; e < couplings_.pairs.size(); ++e) {
    const auto [k, l] = couplings_.pairs[e];
    values_[e] = couplings_.signed_inv_mass[e] * r_new.col(k).dot(r.col(l));
    mirrored_[e] = couplings_.signed_inv_mass[e] * r_new.col(l).dot(r.col(k));
  }
  ldu_.factor(diagonal_, values_, mirrored_);
}

}  // namespace taut
