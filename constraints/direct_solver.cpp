#include "constraints/direct_solver.hpp"

namespace taut {

std::vector<DirectSolver::Coupling> DirectSolver::couplings_of(const System& sys) {
  std::vector<std::vector<int>> bonds_at(sys.atoms());
  for (int k = 0; k < sys.bond_count(); ++k) {
    bonds_at[sys.bonds[k].i].push_back(k);
    bonds_at[sys.bonds[k].j].push_back(k);
  }
  std::vector<Coupling> couplings;
  for (int a = 0; a < sys.atoms(); ++a) {
    if (sys.inv_mass[a] == 0) continue;
    for (std::size_t p = 0; p < bonds_at[a].size(); ++p)
      for (std::size_t q = p + 1; q < bonds_at[a].size(); ++q) {
        const int k = bonds_at[a][p], l = bonds_at[a][q];
        const bool same_end = (sys.bonds[k].i == a) == (sys.bonds[l].i == a);
        couplings.push_back({k, l, same_end ? sys.inv_mass[a] : -sys.inv_mass[a]});
      }
  }
  return couplings;
}

std::vector<SparseLdlt::Pair> DirectSolver::pairs_of(const std::vector<Coupling>& couplings) {
  std::vector<SparseLdlt::Pair> pairs;
  for (const auto& c : couplings) pairs.push_back({c.k, c.l});
  return pairs;
}

DirectSolver::DirectSolver(const System& sys)
    : couplings_(couplings_of(sys)),
      ldlt_(sys.bond_count(), pairs_of(couplings_)),
      reduced_inv_mass_(sys.bond_count()),
      diagonal_(sys.bond_count()),
      values_(couplings_.size()) {
  for (int k = 0; k < sys.bond_count(); ++k)
    reduced_inv_mass_[k] = sys.inv_mass[sys.bonds[k].i] + sys.inv_mass[sys.bonds[k].j];
}

void DirectSolver::factor(const Vectors& r) {
  diagonal_ = reduced_inv_mass_.array() * r.colwise().squaredNorm().transpose().array();
  for (std::size_t e = 0; e < couplings_.size(); ++e) {
    const auto& [k, l, signed_inv_mass] = couplings_[e];
    values_[e] = signed_inv_mass * r.col(k).dot(r.col(l));
  }
  ldlt_.factor(diagonal_, values_);
}

}  // namespace taut
