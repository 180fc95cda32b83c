#pragma once

#include <array>
#include <functional>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/threads.hpp"
#include "constraints/redundancy.hpp"
#include "md/constraint_method.hpp"
#include "md/diagnosis.hpp"
#include "md/observables.hpp"
#include "md/rigid_motions.hpp"
#include "md/step_parts.hpp"
#include "simulation/minimise.hpp"
#include "simulation/temperatures.hpp"
#include "systems/scene/scene.hpp"

namespace taut {

// A symmetric tensor's numbers, and what they are called.
inline constexpr std::array<const char*, 6> kTensorNames = {"xx", "yy", "zz", "xy", "xz", "yz"};
inline std::array<double, 6> six_of(const Eigen::Matrix3d& t) {
  return {t(0, 0), t(1, 1), t(2, 2), t(0, 1), t(0, 2), t(1, 2)};
}

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// Of the bonds of run.tension_of, the mean over them (simulation/held_bonds.hpp).
struct HeldTension {
  double tension = kUnknown;  // [kJ/mol/nm]
  double weight =
      kUnknown;  // √μ [√u]; under the metric correction d [nm]; none where the distribution has no such form
};

// One row of the log; simulation/log_columns.hpp names its numbers.
struct Record {
  long step = 0;
  double t = 0;                       // [ps]
  double potential = 0, kinetic = 0;  // of Simulation::velocity() [kJ/mol]
  double temperature = 0;             // of Simulation::thermal_velocity() [K]
  double full_step_temperature = 0;   // of Simulation::velocity() [K]
  BondErrors bonds;
  // Of the energy but for the heat, so far [kJ/mol/ns/dof]; NaN under a barostat, whose work is not metered.
  double drift = kUnknown;
  // Of the energy since the start, or since the thermostat was changed (md/account.hpp) [kJ/mol]: what the
  // bonds did,
  double constraint_work = 0;
  std::optional<double>
      heat;  // and what thermostat and barostat gave to velocities, and the momentum taken out
  double iterations = kUnknown;  // a step, since the last row
  double ns_per_day = kUnknown;
  std::optional<double> pressure;   // in a box [bar], as what follows
  double volume = 0, density = 0;   // [nm³], [kg/m³]
  Eigen::Matrix3d pressure_tensor;  // [bar]
  std::vector<double>
      walls;  // pressure of the atoms on each wall [bar]; without a box their force [kJ/mol/nm]
  // Done since the start by the moving ends of springs, and by who moves anchors [kJ/mol].
  std::optional<double> steering_work;
  std::optional<double>
      steering_force;               // mean over steered atoms, or over pulls that change in time [kJ/mol/nm]
  std::vector<BiasReading> biases;  // of an angle or torsion in degrees
  std::vector<double> motions;      // power of who moves the anchors of each [kJ/mol/ps]
  std::optional<double> bath_temperature;  // of the thermostat [K]
  std::optional<HeldTension> held;         // where run.tension_of asks for it

  double total() const { return potential + kinetic; }
  // What neither thermostat nor barostat nor what moves springs' ends and anchors brought.
  double but_for_heat() const { return total() - heat.value_or(0) - steering_work.value_or(0); }
};

// How the rows of a run end beside how they began, and what a temperature is to be compared with.
struct StartAndEnd {
  double time = 0;         // from the first row to the last [ps]
  double rise = 0;         // of the energy but for the heat; NaN under a barostat [kJ/mol/degree of freedom]
  double rounding = 0;     // an energy below which nothing is told from rounding [kJ/mol/degree of freedom]
  int dof = 0;             // degrees of freedom
  double expected = 0;     // temperature: a bath's, or the first row's velocities' [K]
  Estimate temperature;    // mean over the later half of the rows [K]
  double relaxation = 0;   // time in which the bath brings a temperature back; 0: there is none [ps]
  bool worked_on = false;  // forces from outside do work: gravity, pulls, code
  bool loses_energy = false;  // as bonds of one side do where they touch
  std::vector<KindOfMolecule> kinds;
};

// Where the time of a run went, from its first step in this process to its end.
struct Timings {
  long steps = 0;
  int threads = 1;
  std::vector<PartTime> parts;  // which do not overlap; none where only the bonds were measured

  // Of the clock on the wall: all parts together.
  double seconds() const {
    return std::transform_reduce(parts.begin(), parts.end(), 0.0, std::plus{},
                                 [](const PartTime& p) { return p.seconds; });
  }
  double ms_a_step(double seconds_of) const {
    return 1e3 * seconds_of / static_cast<double>(std::max(1L, steps));
  }
  // The share of the threads' time in a part in which they wait for each other.
  double waiting_percent(const PartTime& part) const {
    return part.seconds > 0 ? 100 * part.waiting / (threads * part.seconds) : 0;
  }
  double percent(double seconds_of) const { return seconds() > 0 ? 100 * seconds_of / seconds() : 0; }
};

// What a run came to.
struct Summary {
  long steps = 0;
  double us_per_step = 0, constraint_us_per_step = 0, ns_per_day = 0;
  double max_rel_bond_error = 0;  // over all rows
  double rms_rel_bond_error = 0;  // root mean square over the rows' time
  Estimate drift;                 // of the energy but for the heat [kJ/mol/ns/degree of freedom]
  Estimate constraint_drift;      // the bonds' share of it
  double constraint_work = 0;     // and heat: as in the last row [kJ/mol]
  std::optional<double> heat;
  std::optional<double> off_by_k;           // what the drift adds to the thermostat's temperature
  double temperature = 0;                   // mean over the rows' time [K]
  StartAndEnd start_and_end;                // what doubts are judged by, too
  std::optional<Estimate> pressure;         // the same, in a box [bar], as what follows
  Estimate volume, density;                 // [nm³], [kg/m³]
  std::array<Estimate, 6> pressure_tensor;  // kTensorNames [bar]
  std::vector<Estimate> walls;              // as in the log
  struct OfBias {
    Estimate value, force;  // means over the rows' time [nm or °, kJ/mol/nm or /rad]
    long lost = 0;          // rows in which it did not act for want of a direction
  };
  std::vector<OfBias> biases;
  std::optional<Estimate> tension;      // of the bonds of run.tension_of [kJ/mol/nm]
  std::optional<double> steering_work;  // as in the last row [kJ/mol]
  double potential = 0, total = 0;      // at the end [kJ/mol]
  std::optional<bool> converged;    // every step to twice the error the method promises; none: promises none
  std::vector<std::string> doubts;  // simulation/doubts.hpp
  Timings timings;
};

// What it took to bring the start to the bonds.
struct StartReport {
  std::optional<int> pushed_apart;     // moves by soft forces, where run.soft_start asked for them
  std::optional<Minimised> minimised;  // where run.minimise asked for it
  double largest_move = 0;             // of an atom, to the bonds' lengths, after that [nm]
  double centre_stopped = 0;           // speed of the centre of mass that was taken out [nm/ps]
  double kinetic_removed = 0;          // share of the kinetic energy that lay along the bonds
  std::vector<int> anchors_stopped;    // atoms of mass 0 that came with a velocity
};

// How far a run has come. A checkpoint keeps it.
struct RunProgress {
  long step = 0;         // taken so far
  SolveStats since_row;  // worst residual and sum of iterations since the last row

  void serialize(Archive& archive) {
    archive(step, since_row.iterations, since_row.max_residual, since_row.worst_bond);
  }
};

// A scene ready to run: forces and method made, the start brought to the bonds.
class Simulation {
 public:
  // Computes with so many threads as long as it lives, whichever thread calls it.
  explicit Simulation(Scene scene, int threads = available_threads())
      : Simulation(std::move(scene), ThreadScope(threads)) {}
  Simulation(Simulation&&) = delete;  // its barostat refers into it
  ~Simulation();

  int threads() const { return threads_; }
  const Scene& scene() const { return scene_; }
  const System& system_as_given() const { return full_; }  // with the bonds that were left out, if any were
  const State& state() const { return state_; }            // virtual sites have no velocity in it
  State state_to_write() const;                            // there they have
  const DegreesOfFreedom& dof() const { return dof_; }
  int clusters() const;
  const StartReport& start_report() const { return start_report_; }
  const ConstraintMethod& method() const { return *method_; }
  // What holds the bonds at this very instant, whatever method runs: A λ = −(J M⁻¹F + |v_ij|²), tension −λd;
  // of a penalty, what its springs pull. Least norm where bonds are redundant [kJ/mol/nm].
  Eigen::VectorXd bond_tensions() const;
  std::vector<std::pair<std::string, double>> energies() const;  // of the forces, by term [kJ/mol]

  // Of the state as it is now: energies, temperature, errors of bonds.
  Record record() const { return record(thermal_velocity()); }
  // With all of a row but what belongs to a run: drift, iterations, speed.
  Record full_record() const { return full_record(thermal_velocity()); }
  std::optional<Eigen::Matrix3d> pressure_tensor() const {
    return pressure_tensor(thermal_velocity());
  }                                // in a box [bar]
  double constraint_work() const;  // as a row of the log has it [kJ/mol]
  // That of full steps [nm/ps], without what shake leaves of it along the bonds. The energy is taken of it: with it
  // velocity Verlet keeps the energy to h², and forces' work and heat add up to it exactly (md/account.hpp).
  Vectors velocity() const;
  // What temperatures and the pressure are taken of, and thermostats act on: the velocity of the drift ahead, on the
  // tangent of the bonds, P(v + (h/2)M⁻¹f), which is canonical for harmonic motion at any step (docs/ensembles.md). So
  // of bonds that are springs it is without what stretches them, for they start cold and warm up slowly, but under
  // Langevin's thermostat, which heats them at once. The first row's of velocities that were drawn, or of a start
  // at rest, is of velocity(): they are drawn so, and what is at rest has none.
  Vectors thermal_velocity() const;

  // Of the rows so far: translation, rotation and the rest of each type of molecule.
  const Temperatures& temperatures() const { return *temperatures_; }

  // Takes the steps that are left of the scene's. `on_record` sees a row every run.log_every steps, the start
  // and the end; `on_step` sees every step's number, after its row but before the end's, where that is no
  // multiple. Throws SimulationFailure.
  Summary run(const std::function<void(const Record&)>& on_record,
              const std::function<void(long)>& on_step = {});
  // Measures the parts of the steps, which takes some 0.2 µs a step. Systems of 1000 atoms and more do so unasked.
  void measure_parts() { measures_parts_ = true; }
  void stop() { stop_ = true; }                 // from on_step: no further step
  long step() const { return progress_.step; }  // taken so far

  // All that the steps to come and the rows of the log depend on, from on_step: restored by another one made
  // of the same scene, it goes on as this one would, to the last bit. Throws InputError for what is not its
  // own.
  void serialize(Archive& archive);
  void restore(std::string_view kept);

  // Other settings for the steps to come: steps, how often there are rows, frames and checkpoints, thermostat
  // and barostat. Another one is another ensemble: means and the drift set out anew.
  void change(const RunSettings& run);
  // Another step and method: sets out anew with them from where it is. Throws InputError for a method that cannot
  // hold the bonds; all is then as it was.
  void change_step(double dt_fs, const MethodOptions& method);

  // Sets out from other positions and velocities as from a start, between steps, from on_step too: brings
  // them to the bonds, minimised first if the goal's force is above 0; means and the energy's account
  // begin again. Throws SimulationFailure where bonds or method cannot hold them. Whatever it throws, all is
  // then as it was. `on_move` is called before every move of a minimisation; to throw there ends it.
  void set_out_anew(const Vectors& x, const Vectors& v, const MinimiseGoal& goal = {},
                    const OnMove& on_move = {});
  // For a view of the numbers. What is written there has no effect but by set_out_anew().
  State& state() { return state_; }

  // Code from outside acts in its steps: forces or a method of somebody's own, which may throw anything.
  bool runs_foreign_code() const;

  // After run() failed, why: the simulation is then as it was before the first step after which something is
  // wrong. Where foreign code acts run() itself has taken that step back; otherwise this goes back to the
  // last snapshot it kept in memory (every 100 steps) and takes the steps again. Nothing where no step fails:
  // then someone who watched threw.
  std::optional<Diagnosis> diagnose();

 private:
  Simulation(Scene scene, const ThreadScope&);
  void bring_to_the_bonds(const MinimiseGoal& goal, const OnMove& on_move = {});
  void begin_means();
  void note_start();
  void note_unresolved_motion();
  std::uint64_t seed_here() const;
  void make_thermostat();
  void make_barostat();
  void count_degrees_of_freedom(RigidMotions::Which fixed);
  SolveStats take_step();
  bool works_from_outside() const { return scene_.terms.worked_in_time() || !scene_.motions.empty(); }
  double work_from_outside() const;  // so far [kJ/mol]
  State without_constraint_forces() const { return {state_.x, state_.v, state_.F, state_.t, state_.box}; }
  Eigen::VectorXd multipliers(const State& of) const;  // that hold the bonds of one without
  bool has_springs() const { return method_->holds() == ConstraintMethod::Holds::kSprings; }
  Vectors without_stretching(Vectors v) const;
  Vectors kicked_velocity() const;  // v + (h/2)M⁻¹f
  // The same of a row, whose velocity is found once.
  Record record(const Vectors& thermal) const;
  Record full_record(const Vectors& thermal) const;
  std::optional<Eigen::Matrix3d> pressure_tensor(const Vectors& thermal) const;
  HeldTension held_tension(const Vectors& thermal) const;
  void size_sums();
  struct LogSums {  // over the rows of the log
    RunningSlope energy, constraint_work;
    RunningMean pressure, volume, density;
    std::array<RunningMean, 6> pressure_tensor;
    RunningMean temperature;
    std::vector<RunningMean> walls;
    struct OfBias {
      RunningMean value, force;
      long lost = 0;
      void serialize(Archive& archive) { archive(value, force, lost); }
    };
    std::vector<OfBias> biases;
    std::vector<RunningMean> tension;        // of run.tension_of: one, if it is given
    long rows = 0, last_row = 0, steps = 0;  // each row stands for the steps since the one before it
    double largest_error = 0, largest_residual = 0, squares = 0;
    double first_t = 0, first_energy = 0, first_temperature = 0;  // of the first row; but for the heat; of v

    void add(const Record& r, double residual, long since_row);  // steps since the row before
    void serialize(Archive& archive) {
      archive(energy, constraint_work, pressure, volume, density, rows, last_row, steps, largest_error,
              largest_residual, squares, temperature, first_t, first_energy, first_temperature);
      for (RunningMean& mean : pressure_tensor) archive(mean);
      archive(walls);
      for (OfBias& bias : biases) archive(bias);
      for (RunningMean& mean : tension) archive(mean);
    }
  };

  double per_ns_and_dof() const;
  std::optional<double> off_by_k(double drift) const;
  StartAndEnd start_and_end(const Record& end) const;
  double energy_scale(double potential) const;
  // The kinetic energy and a penalty's springs', less the work of forces and the heat: only bonds change it
  // [kJ/mol].
  double unaccounted(double kinetic) const;
  double unaccounted() const;
  // What a row here weighs in means in time.
  long steps_since_row() const;
  Record row(const Vectors& thermal, const SolveStats& since_row, double seconds, long steps);
  Summary summary(const Record& end, double seconds, const PartMeter& meter, long steps) const;
  void expect_numbers() const;  // throws StepFailure where one is none
  void keep_snapshot();
  std::optional<Diagnosis> wrong_with_next_step();
  Diagnosis explained(const SolveStats& stats, const std::string& thrown) const;

  // All that a step or a new start changes is noted, and taken back if it throws
  // (simulation/transaction.cpp).
  void note();
  void take_back();
  void take_back(Diagnosis& of);  // and says how long the bond to blame was before
  void serialize_numbers(Archive& archive);

  int threads_;
  System full_;  // with the bonds that were left out, if any were
  Redundancy redundancy_;
  Scene scene_;
  // What only the simulation itself needs (simulation/inner.hpp): programs that include this header need no
  // headers of forces, thermostats and SIMD.
  struct Inner;
  std::unique_ptr<Inner> inner_;
  double unaccounted_at_start_ = 0, heat_at_start_ = 0,
         work_from_outside_at_start_ = 0;  // or where the thermostat was changed
  std::unique_ptr<ConstraintMethod> method_;
  State state_;
  DegreesOfFreedom dof_;
  RigidMotions::Which fixed_ = RigidMotions::Which::kNone;  // whose momenta are held at zero
  StartReport start_report_;
  RunProgress progress_;
  LogSums sums_;
  std::optional<Temperatures> temperatures_;
  std::string unresolved_;   // the note about a spring that the step does not resolve, if there is one
  std::string ewald_doubt_;  // what is wrong with the parameters of Ewald's sum, if anything is
  std::string snapshot_;     // what serialize() kept
  std::optional<Diagnosis> taken_back_;  // why the last step was
  bool stop_ = false;
  bool measures_parts_;
};

}  // namespace taut
