// What is seen of the fix: degrees of freedom, virial, statistics, numbers and tables for output.

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "lammps/fix_taut.hpp"

namespace LAMMPS_NS {

// A held distance takes one; half of it with each atom in the group, or all with the one that is not `fixed`.
FixTaut::Count FixTaut::dof(int of_group) {
  double ends = 0;
  for (int i = 0; i < atom->nlocal; ++i)
    if (atom->mask[i] & group->bitmask[of_group])
      for (const taut::HeldBond& bond : held_.of(i)) ends += bond.freedom;
  return static_cast<Count>(all_sum(0.5 * ends));
}

// Of a bond Σ r⊗f = λ r⊗r; an atom of this processor's own has half of it.
void FixTaut::tally_virial() {
  const taut::State& s = solve_->state();
  const taut::System& system = solve_->system();
  const auto& images = solve_->local().images;
  const auto& lambda = solve_->lambda();
  for (int k = 0; k < system.bond_count(); ++k) {
    const auto& [i, j, d] = system.bonds[k];
    int own[2], count = 0;
    for (int a : {images[i].atom, images[j].atom})
      if (a < atom->nlocal) own[count++] = a;
    if (count == 0) continue;
    const taut::Vec3 r = s.x.col(j) - s.x.col(i), f = lambda[k] * r;
    double v[6] = {r.x() * f.x(), r.y() * f.y(), r.z() * f.z(), r.x() * f.y(), r.x() * f.z(), r.y() * f.z()};
    v_tally(count, own, 2.0, v);
  }
}

// Rows of atom i, atom j, tension: a bond is listed where its first atom is.
void FixTaut::update_local() {
  const taut::State& s = solve_->state();
  const taut::System& system = solve_->system();
  const auto& images = solve_->local().images;
  const auto& lambda = solve_->lambda();
  tensions_.clear();
  for (int k = 0; k < system.bond_count(); ++k) {
    const auto& [i, j, d] = system.bonds[k];
    if (images[i].atom >= atom->nlocal) continue;
    for (double number :
         {static_cast<double>(atom->tag[images[i].atom]), static_cast<double>(atom->tag[images[j].atom]),
          -lambda[k] * (s.x.col(j) - s.x.col(i)).norm()})
      tensions_.push_back(number);
  }
  size_local_rows = static_cast<int>(tensions_.size() / 3);
  tension_rows_.resize(tensions_.size() / 3 + 1);
  for (int n = 0; n < size_local_rows; ++n) tension_rows_[n] = &tensions_[3 * static_cast<std::size_t>(n)];
  array_local = tension_rows_.data();
}

// Energy of the springs in minimisation.
double FixTaut::compute_scalar() {
  return all_sum(restraint_energy_);
}

double FixTaut::compute_vector(int which) {
  switch (which) {
    case 0:
      return all_max(residual_);
    case 1:
      return all_max(steps_ > 0 ? static_cast<double>(solves_) / static_cast<double>(steps_) : 0);
    case 2:
      return cut_ ? overlap_ : 0;
    case 3:
      return exchanges_;
    default:
      return all_max(mismatch_);
  }
}

double FixTaut::memory_usage() {
  return static_cast<double>(motion_.capacity() * sizeof(double)) + held_.memory_usage();
}

// As fix shake prints them: a line a type, mean length or angle [degrees], largest less smallest, count.
void FixTaut::end_of_step() {
  const int bonds = atom->nbondtypes, kinds = bonds + atom->nangletypes;
  std::vector<double> sum(2 * kinds), range(2 * kinds, -1e300), all_sums(2 * kinds), all_ranges(2 * kinds);
  const auto count = [&](int kind, double weight, double value) {
    sum[2 * kind] += weight;
    sum[2 * kind + 1] += weight * value;
    range[2 * kind] = std::max(range[2 * kind], value);
    range[2 * kind + 1] = std::max(range[2 * kind + 1], -value);
  };
  const auto to = [&](int i, tagint partner) {
    taut::Vec3 r =
        Eigen::Map<const taut::Vec3>(atom->x[atom->map(partner)]) - Eigen::Map<const taut::Vec3>(atom->x[i]);
    taut::minimum_image(*domain, r.data());
    return r;
  };
  for (int i = 0; i < atom->nlocal; ++i) {
    for (const taut::HeldBond& bond : held_.of(i))
      if (bond.kind.is_bond()) count(bond.kind.bond - 1, 0.5, to(i, bond.partner).norm());
    for (int m = 0; atom->num_angle && m < atom->num_angle[i]; ++m) {
      const tagint a = atom->angle_atom1[i][m], c = atom->angle_atom3[i][m];
      const int type = -atom->angle_type[i][m];  // a held angle's is negative
      if (atom->angle_atom2[i][m] != atom->tag[i] || keys_.held.angles.count(type) == 0) continue;
      if (!held_.find(i, a) || !held_.find(i, c)) continue;  // another fix holds it
      const taut::Vec3 first = to(i, a), second = to(i, c);
      const double sine = first.cross(second).norm();
      count(bonds + type - 1, 1, std::atan2(sine, first.dot(second)) * 180 / std::numbers::pi);
    }
  }
  MPI_Reduce(sum.data(), all_sums.data(), 2 * kinds, MPI_DOUBLE, MPI_SUM, 0, world);
  MPI_Reduce(range.data(), all_ranges.data(), 2 * kinds, MPI_DOUBLE, MPI_MAX, 0, world);
  if (comm->me != 0) return;
  std::string text = fmt::format("Taut stats (type/ave/delta/count) on step {}\n", update->ntimestep);
  for (int kind = 0; kind < kinds; ++kind)
    if (all_sums[2 * kind] > 0)
      text += fmt::format("{} {:>4}   {:<12.9g} {:<12.6g} {:>9.9g}\n",
                          kind < bonds ? "Bond: " : "Angle:", kind < bonds ? kind + 1 : kind - bonds + 1,
                          all_sums[2 * kind + 1] / all_sums[2 * kind],
                          all_ranges[2 * kind] + all_ranges[2 * kind + 1], all_sums[2 * kind]);
  utils::logmesg(lmp, text);
}

}  // namespace LAMMPS_NS
