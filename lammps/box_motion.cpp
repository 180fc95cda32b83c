#include "lammps/box_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace taut {

using namespace LAMMPS_NS;

Eigen::Matrix3d box_of(const Domain& box) {
  Eigen::Matrix3d vectors;
  vectors << box.xprd, box.xy, box.xz, 0, box.yprd, box.yz, 0, 0, box.zprd;
  return vectors;
}

void BoxMotion::init() {
  changes_ = false;
  acts_at_end_ = false;
  period_ = 1;
  const Modify& modify = *lmp_->modify;
  for (int k = 0; k < modify.nfix; ++k) {
    const Fix& fix = *modify.fix[k];
    if (!fix.box_change) continue;
    changes_ = true;
    if (!(modify.fmask[k] & FixConst::END_OF_STEP) || (modify.fmask[k] & FixConst::INITIAL_INTEGRATE))
      continue;
    acts_at_end_ = true;
    period_ = std::lcm(period_, std::max(1, fix.nevery));
  }
  deforms_ = lmp_->domain->deform_flag != 0;
}

void BoxMotion::start() {
  box_ = box_of(*lmp_->domain);
  start_step_ = lmp_->update->ntimestep;
  rate_.setZero();
  moves_ = false;
  known_ = {};
  group_is_known_ = false;
  carried_bits_ = 1;
  fixed_point_.setZero();
  x_before_.clear();
}

void BoxMotion::foresee() {
  if (!changes_) return;
  const bigint step = lmp_->update->ntimestep;
  const Eigen::Matrix3d last = last_strain();
  if (!(acts_at_end_ && step - 1 == start_step_)) {  // setup is no step, and has no end
    const int class_of_last = is_strained_by_period(step - 1);
    strain_[class_of_last] = last;
    known_[class_of_last] = true;
  }
  if (!group_is_known_) find_carried_group(last);
  box_ = box_of(*lmp_->domain);

  const int coming = is_strained_by_period(step);
  if (!known_[coming])
    rate_ = deforms_ && (coming == 1 || period_ == 1) ? strain_of_deform() : Eigen::Matrix3d::Zero().eval();
  else
    rate_ = strain_[coming];
  rate_ /= lmp_->update->dt;
  moves_ = !rate_.isZero(0);
}

// H'H⁻¹ − 1. A flip replaces a box vector by itself plus multiples of those before it: the lattice is the same,
// and nothing is strained. Such multiples are added to the box of the step before.
Eigen::Matrix3d BoxMotion::last_strain() const {
  const Eigen::Matrix3d now = box_of(*lmp_->domain);
  if (now == box_) return Eigen::Matrix3d::Zero();
  Eigen::Matrix3d before = box_;
  for (int column : {1, 2})
    for (int row = column - 1; row >= 0; --row)
      before.col(column) +=
          std::round((now(row, column) - before(row, column)) / before(row, row)) * before.col(row);
  return now * before.inverse() - Eigen::Matrix3d::Identity();
}

// By fix deform at the end of this step, from the rates it tells.
Eigen::Matrix3d BoxMotion::strain_of_deform() const {
  const double* const rate = lmp_->domain->h_rate;  // of xx, yy, zz, yz, xz, xy
  Eigen::Matrix3d change;
  change << rate[0], rate[5], rate[4], 0, rate[1], rate[3], 0, 0, rate[2];
  return period_ * lmp_->update->dt * change * box_.inverse();
}

// A carried atom is displaced by strain (x − fixed point) beyond h v, any other by nothing. Of all groups the one
// is chosen that the fewest atoms contradict; atoms near the fixed point tell nothing.
void BoxMotion::find_carried_group(const Eigen::Matrix3d& strain) {
  constexpr int kGroups = 31, kTold = kGroups + 1;  // no atoms are the last choice
  const Atom& atom = *lmp_->atom;
  const std::size_t numbers = 3 * static_cast<std::size_t>(atom.nlocal);
  const bool strained = !strain.isZero(0);  // on all processors or on none
  const bool have = strained && x_before_.size() == numbers;
  std::array<double, kTold + 4> mine{},
      all{};  // contradictions by choice; Σ strain x − displacement; their number
  for (int i = 0; have && i < atom.nlocal; ++i) {
    const Vec3 x = Eigen::Map<const Vec3>(atom.x[i]), v = Eigen::Map<const Vec3>(atom.v[i]);
    const Vec3 before = Eigen::Map<const Vec3>(&x_before_[3 * static_cast<std::size_t>(i)]);
    const Vec3 beyond = x - before - lmp_->update->dt * v;
    const bool carried = beyond.norm() > 1e-3 * strain.norm() * box_.norm();
    for (int g = 0; g < kGroups; ++g) mine[g] += carried != ((atom.mask[i] & (1 << g)) != 0);
    mine[kGroups] += carried;
    if (!carried) continue;
    Eigen::Map<Vec3>(&mine[kTold]) += strain * before - beyond;
    mine[kTold + 3] += 1;
  }
  double told = have;
  if (strained) {
    MPI_Allreduce(mine.data(), all.data(), static_cast<int>(all.size()), MPI_DOUBLE, MPI_SUM, lmp_->world);
    MPI_Allreduce(MPI_IN_PLACE, &told, 1, MPI_DOUBLE, MPI_MIN, lmp_->world);
  }
  if (told > 0) {
    const auto choice = std::min_element(all.begin(), all.begin() + kTold) - all.begin();
    carried_bits_ = choice < kGroups ? 1 << choice : 0;
    if (all[kTold + 3] > 0)
      fixed_point_ = strain.completeOrthogonalDecomposition().solve(
          (Eigen::Map<const Vec3>(&all[kTold]) / all[kTold + 3]).eval());
    group_is_known_ = true;
    x_before_.clear();
    return;
  }
  x_before_.resize(numbers);
  if (atom.nlocal > 0) std::copy_n(atom.x[0], numbers, x_before_.begin());
}

Vec3 BoxMotion::carried(int i) const {
  if (!(lmp_->atom->mask[i] & carried_bits_)) return Vec3::Zero();
  return rate_ * (Eigen::Map<const Vec3>(lmp_->atom->x[i]) - fixed_point_);
}

}  // namespace taut
