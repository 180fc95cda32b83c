#pragma once

#include <array>
#include <vector>

#include "lammps/lammps_headers.hpp"
#include "md/state.hpp"

namespace taut {

// The box vectors, as columns.
Eigen::Matrix3d box_of(const LAMMPS_NS::Domain& box);

// Fixes that change the box (npt, deform, press/berendsen) carry atoms along after fix taut has predicted
// where they go. This class foresees that motion: in the coming step the box is strained as in the last one,
// or, where a fix changes it every N steps only, as at the last multiple of N.
//
// LAMMPS does not tell which atoms are carried (`dilate GROUP`, `remap none`). One step shows it: an atom that
// is carried moves by more than its velocity says. The group (or no atom at all) that agrees best is kept for
// the run.
class BoxMotion {
 public:
  explicit BoxMotion(LAMMPS_NS::LAMMPS* lmp) : lmp_(lmp) {}

  void init();   // looks which fixes change the box, and when
  void start();  // at setup: nothing is known of the box's motion
  void atoms_are_renumbered() { x_before_.clear(); }
  void foresee();  // once a step, where forces are complete

  bool moves() const { return moves_; }
  // Of the coming step, as a velocity: how atom i of this processor is carried.
  Vec3 carried(int i) const;
  // As a velocity: how an image that is n box vectors away moves farther than its atom.
  Vec3 carried_image(const Vec3& n) const { return rate_ * (box_ * n); }

 private:
  Eigen::Matrix3d last_strain() const;
  Eigen::Matrix3d strain_of_deform() const;
  bool is_strained_by_period(LAMMPS_NS::bigint step) const { return period_ > 1 && step % period_ == 0; }
  void find_carried_group(const Eigen::Matrix3d& strain);

  LAMMPS_NS::LAMMPS* lmp_;
  bool changes_ = false, deforms_ = false, moves_ = false;
  bool acts_at_end_ = false;  // fixes change the box at ends of steps
  int period_ = 1;            // steps between two such changes
  LAMMPS_NS::bigint start_step_ = 0;
  Eigen::Matrix3d box_ = Eigen::Matrix3d::Identity(), rate_ = Eigen::Matrix3d::Zero();
  // Of a step: [0] where no fix with a period changes the box, [1] where one does.
  std::array<Eigen::Matrix3d, 2> strain_;
  std::array<bool, 2> known_{};

  bool group_is_known_ = false;
  int carried_bits_ = 1;  // atoms of these groups are carried; 0: none
  Vec3 fixed_point_ = Vec3::Zero();
  std::vector<double> x_before_;  // of this processor's atoms, until the group is known
};

}  // namespace taut
