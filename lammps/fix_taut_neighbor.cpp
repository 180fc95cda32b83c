// Which bonds this processor solves, and how it hears of the others: found anew when atoms change processors.

#include <fmt/format.h>

#include <cmath>

#include "base/errors.hpp"
#include "lammps/cut.hpp"
#include "lammps/fix_taut.hpp"

namespace LAMMPS_NS {

std::string FixTaut::missing_partner(tagint of, tagint partner) const {
  return fmt::format(
      "atom {} is held to atom {}, which is not there or farther than ghost atoms reach; give comm_modify "
      "cutoff more than {:g}",
      of, partner, comm->get_comm_cutoff());
}

// anew: atoms, masses and lengths may be others than in the steps before.
void FixTaut::find_pieces(bool anew) {
  constexpr int kLeastOverlap = 1;
  box_motion_.atoms_are_renumbered();
  refuse_changed_bonds();
  if (!anew) refuse_changed_lengths();
  taut::LocalSystemFinder finder(lmp, held_, lengths_, fixed_bits_);
  const bool same = !anew && finder.find_again(solve_->local());
  const taut::MissingAtom missing = same ? taut::MissingAtom{} : finder.find_depths(keys_.overlap + 2);
  const int reach = -static_cast<int>(all_max(-missing.depth));
  overlap_ = std::min(keys_.overlap, reach - 3);
  if (overlap_ < std::min(kLeastOverlap, keys_.overlap)) {
    if (missing.depth == reach) stop(missing_partner(missing.partner, missing.atom));
    return;  // another processor stops all
  }
  if (!same) {
    try {
      make_solve(finder.find(keys_.overlap));
    } catch (const std::runtime_error& wrong) {
      stop(wrong.what());
    }
  }
  const taut::LocalSystem& local = solve_->local();
  const double mine[] = {static_cast<double>(local.ghosts), static_cast<double>(!local.outer.empty()),
                         left_.now, left_.one_exchange_less, anew ? 0 : residual_};
  double all[5];
  MPI_Allreduce(mine, all, 5, MPI_DOUBLE, MPI_MAX, world);
  warn_of_residual(all[4]);
  ghosts_ = all[0] > 0;
  cut_ = all[1] > 0;
  if (ghosts_) ask_for_ghosts();
  if (cut_) solve_->tell_past();
  shared_r_.resize(3, 0);
  missing_impulses_.setZero(3, static_cast<Eigen::Index>(local.shared.size()));
  outer_is_shifted_ = true;
  exchanges_ = 0;
  left_ = {};
  if (cut_) choose_exchanges({all[2], all[3]});
}

void FixTaut::choose_exchanges(const taut::LeftByCuts& left) {
  constexpr int kMostExchanges = 30, kBeforeKnown = 2;
  if (keys_.clear)
    refuse("clear: clusters are cut between processors, and velocities are cleared in whole ones alone");
  solve_->load_positions(atom->x, *domain);
  const double rho =
      all_max(taut::contraction(solve_->local(), solve_->state().x, solve_->outer_r(), atom->nlocal));
  const bool given = keys_.exchanges >= 0;
  const taut::Cut cut = given ? taut::Cut{keys_.exchanges, taut::guess_order_for(rho, keys_.exchanges)}
                              : taut::choose_cut(rho, kMostExchanges);
  if (cut.guess_order < 0)
    refuse(fmt::format(
        "step {}: chains are so straight that an error beyond a processor's part is felt there by {:.2g}, "
        "overlap {}: {}; give overlap more, and comm_modify cutoff more than {:g}",
        update->ntimestep, rho, overlap_,
        given ? fmt::format("exchanges {} are too few", keys_.exchanges) : "no exchanges will do",
        comm->get_comm_cutoff()));
  exchanges_ = cut.exchanges;
  if (!given) {
    const bool known = exchanges_enough_ >= 0;
    exchanges_enough_ = known ? exchanges_enough_ + taut::change_of_exchanges(left, keys_.tolerance())
                              : cut.exchanges + kBeforeKnown;
    exchanges_enough_ = std::clamp(exchanges_enough_, cut.exchanges, kMostExchanges);
    exchanges_ = exchanges_enough_;
    while (taut::guess_order_for(rho, exchanges_) < 0) ++exchanges_;  // odd and even numbers differ
  }
  guess_order_ = std::min(taut::guess_order_for(rho, exchanges_), solve_->steps_kept() - 1);
  if (left.now > keys_.tolerance() && (given || exchanges_ >= kMostExchanges)) warn_of_cuts(left.now);
}

void FixTaut::warn_of_cuts(double left) {
  if (!warned_ && comm->me == 0)
    error->warning(
        FLERR, fmt::format("Fix taut {}, step {}: bonds between processors are left off by {:.2g}, more than "
                           "{:g}; take more exchanges than {}, or more overlap than {}",
                           id, update->ntimestep, left, keys_.tolerance(), exchanges_, overlap_));
  warned_ = true;
}

// Before the first forces, after minimisation say: bonds that are off would be brought back within one step,
// and their atoms fly apart. Where chains are cut each processor moves its own atoms, until nothing is off.
void FixTaut::setup_pre_force(int) {
  if (held_.steps_known > 0 || is_rerun()) return;  // a run that goes on stays as it is
  constexpr double kSmall = 1e-6,
                   kLost = 0.1;  // what the first step may clear; what is no small displacement
  solve_->load_positions(atom->x, *domain);
  const double off = all_max(solve_->error_now());
  if (!(off > kSmall && off < kLost)) return;
  const auto& images = solve_->local().images;
  for (int n = 0; n < (cut_ ? kRounds : 1); ++n) {
    const taut::Vectors before = solve_->state().x;
    try {
      solve_->project_positions();
    } catch (const taut::SimulationFailure& failure) {
      stop(failure.what());
    }
    for (std::size_t a = 0; a < images.size(); ++a) {
      const auto column = static_cast<Eigen::Index>(a);
      if (const int i = images[a].atom; i < atom->nlocal)
        Eigen::Map<taut::Vec3>(atom->x[i]) += solve_->state().x.col(column) - before.col(column);
    }
    comm->forward_comm();
    solve_->load_positions(atom->x, *domain);
  }
}

}  // namespace LAMMPS_NS
