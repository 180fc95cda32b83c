#include "lammps/fix_taut.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstring>

#include "base/errors.hpp"
#include "base/threads.hpp"

namespace LAMMPS_NS {

using namespace FixConst;
using taut::SolveStats;

FixTaut::FixTaut(LAMMPS* engine, int narg, char** arg)
    : Fix(engine, narg, arg), held_(*atom), lengths_(*force), box_motion_(engine) {
  if (atom->molecular == Atom::TEMPLATE)
    refuse(
        "atom_style template is not carried out; take an atom style that lists bonds, as molecular or full");
  if (atom->molecular != Atom::MOLECULAR)
    refuse("expected an atom style with bonds, as bond, angle, molecular or full");
  if (atom->map_style == Atom::MAP_NONE)
    refuse("expected an atom map; give atom_modify map yes before the box is made");
  try {
    const taut::TypeCounts types{atom->nbondtypes, atom->nangletypes, atom->ntypes};
    keys_ = taut::read_keywords({arg + 3, arg + narg}, types);
    taut::default_threads();  // refuses an OMP_NUM_THREADS that is no number, before there are steps
  } catch (const taut::InputError& wrong) {
    refuse(wrong.what());
  }
  restart_peratom = create_attribute = dof_flag = comm_reverse = 1;
  stores_ids = 1;  // so that reset_atom_ids is refused
  virial_global_flag = virial_peratom_flag = thermo_virial = 1;
  energy_global_flag = thermo_energy = 1;  // of the springs, in minimisation
  scalar_flag = extscalar = 1;
  vector_flag = 1;
  extvector = 0;
  size_vector = 5;
  global_freq = 1;
  nevery = std::max(1, keys_.every);
  if (keys_.store) {
    peratom_flag = local_flag = peratom_freq = local_freq = 1;
    size_peratom_cols = size_local_cols = 3;
    size_local_rows = 0;
  }

  if (keys_.method.name() == "feedforward") motion_size_ = 3;
  hold_bonds();
  comm_border = maxexchange = held_.largest_pack();
  grow_arrays(atom->nmax);
  for (int callback : {Atom::GROW, Atom::RESTART, Atom::BORDER}) atom->add_callback(callback);
}

FixTaut::~FixTaut() {
  for (int callback : {Atom::GROW, Atom::RESTART, Atom::BORDER}) atom->delete_callback(id, callback);
  taut::set_type_signs(*atom, held_, keys_.held.angles, 1);
}

void FixTaut::refuse(const std::string& what) const {
  error->all(FLERR, fmt::format("Fix taut {}: {}", id, what));
}
void FixTaut::stop(const std::string& what) const {
  error->one(FLERR, fmt::format("Fix taut {}, step {}: {}", id, update->ntimestep, what));
}

double FixTaut::all_max(double value) const {
  double all;
  MPI_Allreduce(&value, &all, 1, MPI_DOUBLE, MPI_MAX, world);
  return all;
}
double FixTaut::all_sum(double value) const {
  double all;
  MPI_Allreduce(&value, &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all;
}

void FixTaut::hold_bonds() {
  if (!keys_.fixed_group.empty()) {
    const int fixed = group->find(keys_.fixed_group.c_str());
    if (fixed < 0) refuse(fmt::format("fixed: there is no group \"{}\"", keys_.fixed_group));
    fixed_bits_ = group->bitmask[fixed];
  }
  std::vector<std::vector<taut::HeldBond>> found;
  std::string wrong;
  try {
    found = taut::find_held_bonds(lmp, keys_.held, groupbit, fixed_bits_);
  } catch (const taut::InputError& refusal) {
    wrong = refusal.what();
  }
  if (all_max(!wrong.empty()) > 0)
    wrong.empty() ? refuse("a bond cannot be held, as another processor says") : stop(wrong);
  std::size_t most = 0;
  double ends = 0, angle_ends = 0;
  for (int i = 0; i < atom->nlocal; ++i) {
    most = std::max(most, found[i].size());
    for (const taut::HeldBond& bond : found[i]) (bond.kind.is_bond() ? ends : angle_ends) += 1;
  }
  const double bonds = all_sum(ends) / 2, angles = all_sum(angle_ends) / 2;
  if (bonds == 0) refuse("no bond of the group is of the types and masses given");
  if (!keys_.held.angles.empty() && angles == 0)
    refuse("a: no angle of these types is between two held bonds");
  held_.assign(std::move(found), static_cast<int>(all_max(static_cast<double>(most))), atom->nmax);
  int upward = 0;
  for (int i = 0; i < atom->nlocal; ++i) upward = std::max(upward, held_.count(i) - held_.first_upward(i));
  comm_forward = motion_size_ + static_cast<int>(all_max(upward));
  taut::set_type_signs(*atom, held_, keys_.held.angles, -1);
  if (comm->me == 0)
    utils::logmesg(lmp, fmt::format("Fix taut {}: {} holds {} bonds and {} angles\n", id, keys_.method.name(),
                                    bonds, angles));
}

int FixTaut::setmask() {
  int mask = PRE_EXCHANGE | PRE_NEIGHBOR | PRE_FORCE | POST_FORCE | POST_RUN | MIN_POST_FORCE;
  if (keys_.clear) mask |= FINAL_INTEGRATE;
  if (keys_.every > 0) mask |= END_OF_STEP;
  return mask;
}

void FixTaut::store_past() {
  if (!past_is_new_) return;
  solve_->keep_past();
  held_.steps_known = solve_->steps_known();
  past_is_new_ = false;
}

// Before atoms change processors or a run ends. impulse_time: how long the last forces have acted.
void FixTaut::leave_lists(double impulse_time) {
  store_past();
  if (!cut_) return;
  forward_comm(Forward::kMultipliers);
  compare_shared(impulse_time);
  give_missing_impulses();
}

void FixTaut::make_solve(taut::LocalSystem local) {
  try {
    solve_ = std::make_unique<taut::LocalSolve>(std::move(local), keys_.method, update->dt);
  } catch (const taut::InputError& wrong) {
    stop(wrong.what());
  }
  solve_->load_past(held_.steps_known);
  past_is_new_ = false;
}

void FixTaut::reset_dt() {
  if (!solve_) return;
  store_past();
  make_solve(solve_->local());
}

// --- the step ---

void FixTaut::post_force(int vflag) {
  v_init(vflag);
  find_multipliers();
  apply();
  if (evflag) tally_virial();
}

void FixTaut::setup(int vflag) {
  refuse_rigid_bodies();
  v_init(vflag);
  const auto v = [&] { return atom->nlocal > 0 ? atom->v[0] : nullptr; };
  std::vector<double> before;
  if (is_rerun()) before.assign(v(), v() + 3 * static_cast<std::size_t>(atom->nlocal));
  find_first_multipliers();
  std::ranges::copy(before, v());
  apply();
  if (evflag) tally_virial();
}

void FixTaut::find_multipliers() {
  restraint_energy_ = 0;
  const double h = update->dt;
  kick_ = h * h;
  if (cut_) give_missing_impulses();
  solve_->load_positions(atom->x, *domain);
  box_motion_.foresee();
  forward_comm(Forward::kMotion);
  read_motion();
  if (cut_) {
    read_outer(true);
    compare_shared(acted_ + 0.5 * h);
    outer_is_shifted_ = false;
    solve_->guess_outer(std::min(guess_order_, solve_->steps_known() - 1));
    solve_->add_outer_pull(kick_);
  }
  SolveStats stats = solve_->step();
  require_solved(stats);
  past_is_new_ = true;
  for (int n = 0; n < exchanges_; ++n) {
    solve_->tell_newest();
    forward_comm(Forward::kMultipliers);
    if (n + 1 == exchanges_) look_before_last_exchange();
    read_outer(false);
    if (solve_->feedforward())
      solve_->state().f.setZero();  // where it has put what it found; v is as it was
    else
      read_motion();
    solve_->add_outer_pull(kick_);
    const SolveStats again = solve_->again();
    require_solved(again);
    past_is_new_ = true;
    stats.iterations += again.iterations;
  }
  if (cut_) {
    solve_->tell_newest();
    remember_shared(0.5 * h);
  }
  residual_ = stats.max_residual;
  solves_ += stats.iterations;
  ++steps_;
}

// Velocities are those of full steps. Multipliers that are still right, after another run or a restart, stay:
// the run goes on as if it had not stopped.
void FixTaut::find_first_multipliers() {
  const double h = update->dt;
  constexpr double kStillRight = 1e-8;
  kick_ = 0.5 * h * h;
  box_motion_.start();
  solve_->load_positions(atom->x, *domain);
  forward_comm(Forward::kMotion);
  read_motion();
  if (held_.steps_known > 0) {
    read_outer(true);
    solve_->guess_outer(0);
    solve_->add_outer_pull(kick_);
    if (all_max(solve_->error_ahead(kick_)) < kStillRight + 10 * all_max(residual_)) {
      read_motion();
      solve_->add_past_forces();
      return;
    }
  }
  const int rounds = cut_ ? kRounds : 1;
  project_velocities(rounds);
  std::ranges::fill(solve_->outer_lambda, 0);
  for (int n = 0; n < rounds; ++n) {
    forward_comm(Forward::kMotion);
    read_motion();
    if (n > 0) read_outer(false);
    solve_->add_outer_pull(kick_);
    require_solved(solve_->start());
    past_is_new_ = true;
    store_past();
    held_.steps_known = 1;
    solve_->load_past(1);
  }
  if (cut_) remember_shared(0);
}

void FixTaut::read_motion() {
  taut::State& s = solve_->state();
  solve_->motions_were_read();
  const auto& images = solve_->local().images;
  if (motion_size_ == 3) s.f.setZero();
  for (std::size_t a = 0; a < images.size(); ++a) {
    const double* const motion = motion_of(images[a].atom);
    double* const v = &s.v(0, static_cast<Eigen::Index>(a));
    double* const f = &s.f(0, static_cast<Eigen::Index>(a));
    for (int c = 0; c < 3; ++c) v[c] = motion[c];
    if (motion_size_ > 3)
      for (int c = 0; c < 3; ++c) f[c] = motion[3 + c];
  }
  if (!box_motion_.moves()) return;
  for (std::size_t a = 0; a < images.size(); ++a) {
    const taut::Vec3 n = Eigen::Map<const Eigen::Vector3i>(images[a].vectors.data()).cast<double>();
    if (!n.isZero(0)) s.v.col(static_cast<Eigen::Index>(a)) += box_motion_.carried_image(n);
  }
}

void FixTaut::require_solved(const SolveStats& stats) const {
  constexpr double kBroken = 0.1;
  if (stats.converged() && stats.max_residual < kBroken) return;
  const int k = std::max(stats.worst_bond, 0);
  if (solve_->system().bond_count() == 0) return;
  const auto& [i, j, d] = solve_->system().bonds[k];
  const auto& images = solve_->local().images;
  const double now = (solve_->state().x.col(j) - solve_->state().x.col(i)).norm();
  stop(fmt::format(
      "the bond of atoms {} and {} is lost: {:.6g} long, held at {:.6g}; {}; take a shorter step, or see "
      "what drives these atoms",
      atom->tag[images[i].atom], atom->tag[images[j].atom], now, d,
      stats.converged() ? "it is off by more than a tenth" : in_words(stats.failure)));
}

void FixTaut::apply() {
  const taut::State& s = solve_->state();
  const auto& images = solve_->local().images;
  const bool add = solve_->feedforward();
  if (keys_.store) std::fill(forces_.begin(), forces_.end(), 0);
  for (std::size_t a = 0; a < images.size(); ++a) {
    const int i = images[a].atom;
    if (i >= atom->nlocal) continue;
    for (int c = 0; c < 3; ++c) {
      const double before = atom->f[i][c], found = s.f(c, static_cast<Eigen::Index>(a));
      atom->f[i][c] = add ? before + found : found;
      if (keys_.store) forces_[3 * static_cast<std::size_t>(i) + c] = atom->f[i][c] - before;
    }
  }
  if (keys_.store) update_local();
}

}  // namespace LAMMPS_NS
