#pragma once

#include <memory>
#include <optional>
#include <unordered_map>

#include "lammps/cut.hpp"
#include "lammps/local_solve.hpp"

namespace LAMMPS_NS {

// fix ID group taut METHOD keyword value ...
// Holds bonds by the methods of `constraints`: in post_force, where velocities are those of the half step, it
// adds Jᵀλ. A step has one forward communication for the ghosts of clusters; every processor solves the bonds
// of its own atoms, and what it finds it applies to its own atoms alone: nothing is sent back.
class FixTaut : public Fix {
 public:
  FixTaut(LAMMPS*, int narg, char** arg);
  ~FixTaut() override;

  int setmask() override;
  void init() override;

  // The step.
  void pre_exchange() override { leave_lists(acted_ + 0.5 * update->dt); }
  void setup_pre_neighbor() override {
    refuse_lost_bonds();
    find_pieces(true);
  }
  void pre_neighbor() override { find_pieces(false); }
  void setup_pre_force(int vflag) override;
  void setup(int vflag) override;
  void post_force(int vflag) override;
  void final_integrate() override;
  void end_of_step() override;
  void post_run() override;
  void reset_dt() override;

  // Minimisation: springs in place of held bonds.
  void min_setup(int vflag) override {
    held_.steps_known = 0;
    ghosts_ = cut_ = false;  // springs need nothing of others but positions; lists are built without this fix
    choose_stiffness();
    min_post_force(vflag);
  }
  void min_post_force(int vflag) override;

  using Count = decltype(std::declval<Fix&>().dof(0));  // int, or bigint since 2025
  Count dof(int of_group) override;
  double compute_scalar() override;
  double compute_vector(int which) override;

  // What is known with atoms.
  void grow_arrays(int room) override;
  void copy_arrays(int from, int to, int) override { held_.copy(from, to); }
  void set_arrays(int i) override { held_.clear(i); }
  int pack_exchange(int i, double* buffer) override { return held_.pack(i, buffer); }
  int unpack_exchange(int i, double* buffer) override { return held_.unpack(i, buffer); }
  int pack_border(int n, int* list, double* buffer) override;
  int unpack_border(int n, int first, double* buffer) override;
  int size_restart(int i) override;
  int maxsize_restart() override { return 2 + held_.largest_pack(); }
  int pack_restart(int i, double* buffer) override;
  void unpack_restart(int i, int nth) override;
  int pack_forward_comm(int n, int* list, double* buffer, int, int*) override;
  void unpack_forward_comm(int n, int first, double* buffer) override;
  int pack_reverse_comm(int n, int first, double* buffer) override;
  void unpack_reverse_comm(int n, int* list, double* buffer) override;
  double memory_usage() override;

 private:
  // What a forward communication brings ghosts.
  enum class Forward { kMotion, kVelocities, kMultipliers };

  [[noreturn]] void refuse(const std::string& what) const;  // all processors
  [[noreturn]] void stop(const std::string& what) const;    // this one
  void hold_bonds();
  bool is_rerun() const;
  bool holds_bonds(const Fix& fix) const;
  void check_order() const;
  void refuse_rigid_bodies() const;
  void refuse_atoms_held_twice() const;
  void refuse_changed_bonds() const;
  void refuse_lost_bonds() const;
  void refuse_changed_lengths();
  void warn_of_residual(double residual);
  void choose_stiffness();

  void store_past();
  void leave_lists(double impulse_time);
  void find_pieces(bool anew);
  void make_solve(taut::LocalSystem local);
  void ask_for_ghosts();
  void forward_comm(Forward what);
  int motion_sent() const;
  bool forwards_multipliers() const { return cut_ && forward_ != Forward::kVelocities; }
  std::string missing_partner(tagint atom, tagint partner) const;
  void choose_exchanges(const taut::LeftByCuts& left);
  void warn_of_cuts(double left);
  void set_own_motion();
  double* motion_of(int i) { return &motion_[static_cast<std::size_t>(i) * motion_size_]; }
  bool is_fixed(int i) const { return (atom->mask[i] & fixed_bits_) != 0; }
  bool carries_with_box() const { return forward_ == Forward::kMotion && box_motion_.moves(); }
  void read_motion();
  void read_outer(bool next_step);
  void remember_shared(double acted);
  double difference_of(int shared) const;
  double left_by(int shared) const;
  void look_before_last_exchange();
  void compare_shared(double impulse_time);
  void give_missing_impulses();
  void find_multipliers();
  void find_first_multipliers();
  void read_velocities();
  void write_velocities();
  void project_velocities(int rounds);
  void apply();
  void require_solved(const taut::SolveStats& stats) const;
  void tally_virial();
  void update_local();
  double all_max(double value) const;
  double all_sum(double value) const;
  double mass(int i) const { return atom->rmass ? atom->rmass[i] : atom->mass[atom->type[i]]; }

  taut::Keywords keys_;
  taut::HeldBonds held_;
  taut::Lengths lengths_;
  int fixed_bits_ = 0;  // of the group of atoms that bonds cannot move
  std::unique_ptr<taut::LocalSolve> solve_;
  bool past_is_new_ = false;  // the method's past is newer than the atoms'

  // Of all processors:
  bool ghosts_ = false, cut_ = false;
  int overlap_ = 0, exchanges_ = 0, guess_order_ = 0;
  int exchanges_enough_ = -1;  // by what cuts have left; less than 0: not known
  bool warned_ = false, warned_of_residual_ = false;

  Forward forward_ = Forward::kMotion;
  taut::BoxMotion box_motion_;
  double kick_ = 0;                            // h² or, the first time, ½h²
  bool outer_is_shifted_ = false;              // the past of multipliers beyond has the last step's already
  taut::Vectors shared_r_, missing_impulses_;  // of bonds between two processors
  double acted_ = 0;                           // how long the last forces have, when their step ends
  taut::LeftByCuts left_;                      // since lists were built, by this processor's
  std::vector<double> cleared_from_;
  int motion_size_ = 6;         // 3 of feedforward
  std::vector<double> motion_;  // motion_size_ numbers an atom, ghosts included

  // Ghosts that some processor solves with, this one or one that they come to from here; and for each message
  // of a forward communication, by LAMMPS's list of its atoms or its first ghost, the atoms that are in it and their
  // bonds to higher tags.
  struct Message {
    std::vector<int> atoms;
    std::vector<taut::HeldBond*> upward;
    void add(int i, taut::HeldBonds& held);
  };
  std::vector<char> asked_for_;
  std::unordered_map<const int*, Message> told_;
  std::unordered_map<int, Message> heard_;

  static constexpr int kRounds = 50;  // at the start, from a guess of nothing beyond a cut

  // Of the last step, and since statistics were last printed.
  double residual_ = 0, mismatch_ = 0;
  long solves_ = 0, steps_ = 0;
  double restraint_energy_ = 0, stiffness_ = 0;  // of the springs in minimisation
  std::vector<double> forces_, tensions_;        // of `store`
  std::vector<double*> force_rows_, tension_rows_;
};

}  // namespace LAMMPS_NS
