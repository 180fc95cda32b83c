#include "lammps/local_solve.hpp"

#include <algorithm>

#include "constraints/bond_algebra.hpp"
#include "constraints/direct_solver.hpp"

namespace taut {

LocalSolve::LocalSolve(LocalSystem local, const MethodOptions& method, double h)
    : outer_lambda(local.outer.size()),
      local_(std::move(local)),
      h_(h),
      feedforward_(method.name() == "feedforward"),
      method_(make_method(local_.system, method, h)),
      history_(dynamic_cast<MultiplierHistory*>(method_.get())),
      past_(Eigen::MatrixXd::Zero(local_.system.bond_count(), history_->steps_kept())),
      outer_r_(3, local_.outer.size()),
      pulled_(local_.outer.size()) {
  s_.x = s_.v = s_.f = Vectors::Zero(3, local_.system.atoms());
}

void LocalSolve::load_past(int known) {
  for (Eigen::Index k = 0; k < past_.rows(); ++k)
    for (Eigen::Index n = 0; n < past_.cols(); ++n) past_(k, n) = local_.places[k][0]->past[n];
  history_->write(past_, std::min(known, history_->steps_kept()));
}

void LocalSolve::keep_past() {
  history_->read(past_);
  for (Eigen::Index k = 0; k < past_.rows(); ++k)
    for (HeldBond* bond : local_.places[k])
      for (Eigen::Index n = 0; n < past_.cols(); ++n) bond->past[n] = past_(k, n);
  tell_past();
}

void LocalSolve::tell_past() {
  for (const auto& bonds : local_.places)
    for (HeldBond* bond : bonds) bond->told = bond->past[0];
}

void LocalSolve::tell_newest() {
  const Eigen::VectorXd& newest = lambda();
  for (const auto& [k, bond] : local_.told) bond->told = newest[k];
}

void LocalSolve::load_positions(double** x, const LAMMPS_NS::Domain& box) {
  const Eigen::Matrix3d vectors = box_of(box);
  const auto at = [&](const Image& image) -> Vec3 {
    const auto& [a, b, c] = image.vectors;
    const Vec3 place = Eigen::Map<const Vec3>(x[image.atom]);
    if (a == 0 && b == 0 && c == 0) return place;
    return place + vectors * Vec3(a, b, c);
  };
  for (Eigen::Index a = 0; a < s_.x.cols(); ++a) s_.x.col(a) = at(local_.images[a]);
  for (Eigen::Index b = 0; b < outer_r_.cols(); ++b)
    outer_r_.col(b) = at(local_.outer[b].outer) - s_.x.col(local_.outer[b].inner);
}

void LocalSolve::add_outer_pull(double kick) {
  for (Eigen::Index b = 0; b < outer_r_.cols(); ++b) {
    const int a = local_.outer[b].inner;
    const Vec3 force = (pulled_[b] - outer_lambda[b]) * outer_r_.col(b);
    pulled_[b] = outer_lambda[b];
    if (feedforward_)
      s_.v.col(a) += kick / h_ * local_.system.inv_mass[a] * force;
    else
      s_.f.col(a) += force;
  }
}

void LocalSolve::guess_outer(int order) {
  for (std::size_t b = 0; b < outer_lambda.size(); ++b) {
    const auto& past = local_.outer[b].held->past;
    const double guess[] = {past[0], 2 * past[0] - past[1], 3 * (past[0] - past[1]) + past[2]};
    outer_lambda[b] = guess[std::max(order, 0)];
  }
}

double LocalSolve::error_ahead(double kick) const {
  Vectors change = h_ * s_.v;
  const System& system = local_.system;
  if (!feedforward_) change += kick * (s_.f.array().rowwise() * system.inv_mass.transpose().array()).matrix();
  for (int k = 0; k < system.bond_count(); ++k) {
    const auto& [i, j, d] = system.bonds[k];
    const Vec3 pull = kick * past_(k, 0) * (s_.x.col(j) - s_.x.col(i));
    change.col(i) -= system.inv_mass[i] * pull;
    change.col(j) += system.inv_mass[j] * pull;
  }
  double worst = 0;
  for (int k = 0; k < system.bond_count(); ++k) {
    const auto& [i, j, d] = system.bonds[k];
    const Vec3 next = s_.x.col(j) - s_.x.col(i) + change.col(j) - change.col(i);
    worst = std::max(worst, 0.5 * std::abs(next.squaredNorm() / (d * d) - 1));
  }
  return worst;
}

double LocalSolve::error_now() const {
  double worst = 0;
  for (const auto& [i, j, d] : local_.system.bonds)
    worst = std::max(worst, 0.5 * std::abs((s_.x.col(j) - s_.x.col(i)).squaredNorm() / (d * d) - 1));
  return worst;
}

void LocalSolve::add_past_forces() {
  const System& system = local_.system;
  for (int k = 0; k < system.bond_count(); ++k) {
    const auto& [i, j, d] = system.bonds[k];
    const Vec3 pull = past_(k, 0) * (s_.x.col(j) - s_.x.col(i));
    s_.f.col(i) -= pull;
    s_.f.col(j) += pull;
  }
}

SolveStats LocalSolve::project_velocities() {
  if (!projection_) projection_ = make_method(local_.system, default_options("newton"), h_);
  return projection_->project_velocities(local_.system, h_, s_);
}

SolveStats LocalSolve::project_velocities_at_start() {
  const System& system = local_.system;
  for (Eigen::Index b = 0; b < outer_r_.cols(); ++b) {
    const int a = local_.outer[b].inner;
    s_.v.col(a) -= system.inv_mass[a] * outer_lambda[b] * outer_r_.col(b);
  }
  if (!direct_) direct_ = std::make_unique<DirectSolver>(system);
  DirectSolver& solver = *direct_;
  Vectors r(3, system.bond_count()), v_ij(3, system.bond_count());
  differences(system, s_.x, r);
  solver.factor(r);
  if (solver.singular())
    return {.worst_bond = solver.dependent_bonds().front(), .failure = Failure::kSingular};
  differences(system, s_.v, v_ij);
  Eigen::VectorXd mu = -r.cwiseProduct(v_ij).colwise().sum().transpose();
  solver.solve(mu);
  add_constraint_acceleration(system, r, mu, s_.v);
  for (int k = 0; k < system.bond_count(); ++k)
    for (HeldBond* bond : local_.places[k]) bond->told = mu[k];
  return {};
}

}  // namespace taut
