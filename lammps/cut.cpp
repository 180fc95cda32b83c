#include "lammps/cut.hpp"

#include <algorithm>
#include <cmath>

#include "constraints/bond_algebra.hpp"
#include "constraints/direct_solver.hpp"

namespace taut {

namespace {

// Whether a cluster's bonds follow each other along a chain that goes on beyond its ends alone.
bool is_chain(const LocalSystem& local, const CutCluster& cluster) {
  const auto& [first, end, first_outer, end_outer] = cluster;
  const std::vector<RigidBond>& bonds = local.system.bonds;
  if (first == end) return false;
  for (int k = first; k + 1 < end; ++k)
    if (bonds[k].j != bonds[k + 1].i) return false;
  for (int outer = first_outer; outer < end_outer; ++outer) {
    const int inner = local.outer[outer].inner;
    if (inner != bonds[first].i && inner != bonds[end - 1].j) return false;
  }
  return true;
}

// What a chain's bonds feel of unit multipliers beyond its ends, |λ|, added to `response`: bonds are eliminated towards
// the end with the outer bond, and substituted back. Each |λ| is the one before times a ratio: signs do not matter.
void add_response_of_chain(const LocalSystem& local, const CutCluster& cluster, const Vectors& x,
                           const Vectors& outer_r, Eigen::VectorXd& response) {
  const auto& [first, end, first_outer, end_outer] = cluster;
  const std::vector<RigidBond>& bonds = local.system.bonds;
  const Eigen::VectorXd& inv_mass = local.system.inv_mass;
  const auto r = [&](int k) -> Vec3 { return x.col(bonds[k].j) - x.col(bonds[k].i); };
  const int last = end - 1;
  std::vector<double> d(end - first), c(end - first);
  for (int outer = first_outer; outer < end_outer; ++outer) {
    const int inner = local.outer[outer].inner;
    const bool after = inner == bonds[last].j;
    const int from = after ? first : last, to = after ? last : first, onwards = after ? 1 : -1;
    for (int k = from;; k += onwards) {
      const Vec3 r_k = r(k);
      d[k - first] = (inv_mass[bonds[k].i] + inv_mass[bonds[k].j]) * r_k.squaredNorm();
      if (k != from) d[k - first] -= c[k - onwards - first] * c[k - onwards - first] / d[k - onwards - first];
      if (k == to) break;
      c[k - first] = inv_mass[after ? bonds[k].j : bonds[k].i] * r_k.dot(r(k + onwards));
    }
    double lambda = std::abs(inv_mass[inner] * r(to).dot(outer_r.col(outer)) / d[to - first]);
    response[to] += lambda;
    for (int k = to; k != from;) {
      k -= onwards;
      lambda *= std::abs(c[k - first] / d[k - first]);
      response[k] += lambda;
    }
  }
}

// The same for clusters of any shape.
void add_response(const LocalSystem& local, const std::vector<CutCluster>& clusters, const Vectors& x,
                  const Vectors& outer_r, Eigen::VectorXd& response) {
  System cut;
  cut.mass = local.system.mass;
  cut.inv_mass = local.system.inv_mass;
  std::vector<int> numbers;
  std::size_t most_outer = 0;
  for (const auto& [first, end, first_outer, end_outer] : clusters) {
    for (int k = first; k < end; ++k) {
      cut.bonds.push_back(local.system.bonds[k]);
      numbers.push_back(k);
    }
    most_outer = std::max<std::size_t>(most_outer, end_outer - first_outer);
  }
  DirectSolver solver(cut);
  Vectors r(3, cut.bond_count()), a(3, cut.atoms()), a_ij(3, cut.bond_count());
  differences(cut, x, r);
  solver.factor(r);
  Eigen::VectorXd b(cut.bond_count());
  for (std::size_t n = 0; n < most_outer; ++n) {  // one outer bond of each cluster at a time
    a.setZero();
    for (const CutCluster& cluster : clusters) {
      const int outer = cluster.first_outer + static_cast<int>(n);
      if (outer >= cluster.end_outer) continue;
      const int inner = local.outer[outer].inner;
      a.col(inner) = -cut.inv_mass[inner] * outer_r.col(outer);
    }
    differences(cut, a, a_ij);
    b = -r.cwiseProduct(a_ij).colwise().sum().transpose();
    solver.solve(b);
    for (std::size_t k = 0; k < numbers.size(); ++k) response[numbers[k]] += std::abs(b[k]);
  }
}

}  // namespace

double contraction(const LocalSystem& local, const Vectors& x, const Vectors& outer_r, int own) {
  const auto& bonds = local.system.bonds;
  Eigen::VectorXd response = Eigen::VectorXd::Zero(local.system.bond_count());
  std::vector<CutCluster> others;
  for (const CutCluster& cluster : local.cut)
    if (is_chain(local, cluster))
      add_response_of_chain(local, cluster, x, outer_r, response);
    else
      others.push_back(cluster);
  if (!others.empty()) add_response(local, others, x, outer_r, response);
  double largest = 0;
  const auto is_own = [&](int atom) { return local.images[atom].atom < own; };
  for (int k = 0; k < local.system.bond_count(); ++k)
    if (is_own(bonds[k].i) || is_own(bonds[k].j)) largest = std::max(largest, response[k]);
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
