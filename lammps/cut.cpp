#include "lammps/cut.hpp"

#include <algorithm>
#include <cmath>

#include "constraints/bond_algebra.hpp"
#include "constraints/direct_solver.hpp"

namespace taut {

double contraction(const LocalSystem& local, const Vectors& x, const Vectors& outer_r, int own) {
  System cut;
  cut.mass = local.system.mass;
  cut.inv_mass = local.system.inv_mass;
  std::size_t most_outer = 0;
  for (const auto& [first, end, first_outer, end_outer] : local.cut) {
    cut.bonds.insert(cut.bonds.end(), local.system.bonds.begin() + first, local.system.bonds.begin() + end);
    most_outer = std::max<std::size_t>(most_outer, end_outer - first_outer);
  }
  DirectSolver solver(cut);
  Vectors r(3, cut.bond_count()), a(3, cut.atoms()), a_ij(3, cut.bond_count());
  differences(cut, x, r);
  solver.factor(r);
  Eigen::VectorXd response = Eigen::VectorXd::Zero(cut.bond_count()), b(cut.bond_count());
  for (std::size_t n = 0; n < most_outer; ++n) {  // one outer bond of each cluster at a time
    a.setZero();
    for (const CutCluster& cluster : local.cut) {
      const int outer = cluster.first_outer + static_cast<int>(n);
      if (outer >= cluster.end_outer) continue;
      const int inner = local.outer[outer].inner;
      a.col(inner) = -cut.inv_mass[inner] * outer_r.col(outer);
    }
    differences(cut, a, a_ij);
    b = -r.cwiseProduct(a_ij).colwise().sum().transpose();
    solver.solve(b);
    response += b.cwiseAbs();
  }
  double largest = 0;
  for (int k = 0; k < cut.bond_count(); ++k) {
    const auto is_own = [&](int atom) { return local.images[atom].atom < own; };
    if (is_own(cut.bonds[k].i) || is_own(cut.bonds[k].j)) largest = std::max(largest, response[k]);
  }
  return largest;
}

int guess_order_for(double contraction, int exchanges) {
  constexpr double kSpare = 0.8;
  constexpr double kBelow[] = {1.0 / 7, 1.0 / 15, 1.0 / 31}, kAbove[] = {1.0 / 2, 1.0 / 5, 1.0 / 12.1};
  const double rho = std::pow(contraction, exchanges + 1);
  const auto& bound = exchanges % 2 == 1 ? kAbove : kBelow;  // an even power is positive
  for (int order = 2; order >= 0; --order)
    if (rho < kSpare * bound[order]) return order;
  return -1;
}

Cut choose_cut(double contraction, int most) {
  constexpr int kWorth[] = {0, 2, 1};  // so many exchanges more are worth a guess of this order
  for (int order : {2, 1, 0})
    for (int exchanges = 0; exchanges <= (order > 0 ? std::min(most, kWorth[order]) : most); ++exchanges)
      if (guess_order_for(contraction, exchanges) >= order)
        return {exchanges, guess_order_for(contraction, exchanges)};
  return {-1, -1};
}

int change_of_exchanges(const LeftByCuts& left, double tolerance) {
  constexpr double kWellBelow = 0.1;  // what comes and goes asks for no change back and forth
  if (left.now > 0.5 * tolerance) return 1;
  return left.one_exchange_less >= 0 && left.one_exchange_less < 0.5 * kWellBelow * tolerance ? -1 : 0;
}

}  // namespace taut
