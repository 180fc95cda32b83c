#include "systems/scene/run_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "files/h5md_file.hpp"
#include "md/bonds_by_atoms.hpp"
#include "systems/scene/velocities.hpp"

namespace taut {
namespace {

constexpr Range kCounts{.min = 1};
constexpr double kMostAtoms = 1e9;

void read_temperature(const TomlTable& table, RunSettings& run) {
  Course course = run.temperature_course;
  if (course.empty()) course = Course({{0, run.temperature_k}});
  table.read(
      "temperature_k", course,
      {"of velocities that are drawn, and of the thermostat; rows [ps, K]: the thermostat's, along straight "
       "lines; 0: none",
       "K", kNotNegative});
  run.temperature_k = course.at(0);
  run.temperature_course = course.points().size() > 1 ? std::move(course) : Course();
}

void read_barostat(const TomlTable& table, RunSettings& run) {
  table.read("barostat", run.barostat,
             {"what keeps the pressure: stochastic cell rescaling, or whole molecules by Monte Carlo",
              {"none", "c-rescale", "monte-carlo"}});
  table.read("pressure_bar", run.pressure_bar, {"pressure the barostat keeps", "bar"});
  table.read("barostat_every", run.barostat_every,
             {"from one change of the box to the next", "steps", kCounts});
  table.read("barostat_ps", run.barostat_ps, {"relaxation time of the box", "ps", kPositive});
  table.read("compressibility_per_bar", run.compressibility_per_bar,
             {"a guess of the compressibility, which sets the pace alone; water's", "1/bar", kPositive});
  table.read(
      "coupling", run.coupling,
      {"which edges change alike: all, x and y, none", {"isotropic", "semi-isotropic", "anisotropic"}});

  for (const char* key : {"pressure_bar", "barostat_every"})
    table.require_effect(key, run.barostat != "none", "with run.barostat = \"c-rescale\" or \"monte-carlo\"",
                         {"barostat"});
  for (const char* key : {"barostat_ps", "compressibility_per_bar", "coupling"})
    table.require_effect(key, run.barostat == "c-rescale", "with run.barostat = \"c-rescale\"", {"barostat"});
}

void read_tensions(const TomlTable& table, RunSettings& run) {
  Rows pairs;
  const bool there =
      table.read("tension_of", pairs, {2, 2},
                 {"rigid bonds [i, j] whose mean tension the log has, atoms counted from 0, -1 is the last"});
  if (there) run.tension_of.clear();
  for (std::size_t row = 0; row < pairs.size(); ++row) {
    for (const double atom : pairs[row])
      if (atom != std::round(atom) || std::abs(atom) > kMostAtoms)
        table.fail("tension_of", row, fmt::format("there is no atom {:g}", atom));
    run.tension_of.push_back({static_cast<int>(pairs[row][0]), static_cast<int>(pairs[row][1])});
  }
}

// Of keys that contradict each other the first that an override gives, or else the last that is there.
std::string_view at_fault(const TomlTable& table, std::initializer_list<std::string_view> keys) {
  std::string_view there = *keys.begin();
  for (const std::string_view key : keys) {
    if (table.overridden(key)) return key;
    if (table.has(key)) there = key;
  }
  return there;
}

// After the thermostat is known.
void check_courses(const TomlTable& table, const RunSettings& run) {
  if (run.temperature_course.empty()) return;
  for (std::size_t k = 0; k < run.temperature_course.points().size(); ++k)
    if (run.temperature_course.points()[k].value == 0)
      table.fail("temperature_k", k, "expected a temperature above 0");
  if (!run.thermostatted())
    table.fail("temperature_k",
               "no thermostat follows rows of time and temperature; give run.thermostat, or one temperature");
  if (run.metric_correction)
    table.fail("metric_correction", "takes one run.temperature_k, not rows of time and temperature");
}

}  // namespace

void read_run(const TomlTable& table, RunSettings& run) {
  table.read("dt_fs", run.dt_fs, {"length of a step", "fs", kPositive});
  table.read("steps", run.steps, {"how many steps", "", kNotNegative});
  read_temperature(table, run);
  table.read("pull_factor", run.pull_factor,
             {"rows [ps, number] by which all pulls are multiplied, along straight lines; if not said, 1"});
  table.read("seed", run.seed, {"of all that is drawn", "", kNotNegative});
  table.read("log_every", run.log_every, {"from row to row of the log", "steps", kCounts});
  table.read("remove_momentum_every", run.remove_momentum_every,
             {"from one removal of the whole's momentum to the next; 0: never", "steps", kNotNegative});
  table.read("trajectory_every", run.trajectory_every,
             {"from frame to frame; 0: no trajectory", "steps", kNotNegative});
  table.read("trajectory", run.trajectory, {"its format", {"dcd", "h5md", "both"}});
  table.read(
      "checkpoint_every", run.checkpoint_every,
      {"a checkpoint every so many, besides those by the clock; 0: none besides", "steps", kNotNegative});
  table.read("checkpoint_minutes", run.checkpoint_minutes,
             {"of computing from checkpoint to checkpoint; 0: not by the clock", "min", kNotNegative});
  table.read("redundant", run.redundant, {"bonds that follow from others", {"refuse", "drop"}});
  table.read("thermostat", run.thermostat,
             {"what keeps the temperature; if not said, rescaling where thermostat_ps is above 0",
              {"none", "langevin", "rescaling"}});
  table.read("thermostat_ps", run.thermostat_ps,
             {"relaxation time of velocity rescaling; 0: none", "ps", kNotNegative});
  table.read("friction_per_ps", run.friction_per_ps,
             {"friction of Langevin's thermostat", "1/ps", kNotNegative});
  table.read("minimise", run.minimise, {"relax the start first"});
  table.read("soft_start", run.soft_start,
             {"before that push overlapping atoms apart by soft forces, A(1 + cos(πr/r_c)) between pairs"});
  table.require_effect("soft_start", run.minimise, "with run.minimise = true", {"minimise"});
  table.read("minimise_force_kj_mol_nm", run.minimise_force,
             {"until no atom's force is above this", "kJ/mol/nm", kPositive});
  table.read(
      "metric_correction", run.metric_correction,
      {"Fixman's potential ½kT ln det A at run.temperature_k: rigid bonds with the statistics of flexible "
       "chains"});
  if (run.metric_correction && run.temperature_k == 0)
    table.fail("metric_correction", "needs a run.temperature_k above 0, as 300");
  read_tensions(table, run);
  table.read("velocities", run.velocities,
             {"those of the start, or drawn; if not said, drawn where it has none", {"keep", "draw"}});

  table.require_effect("minimise_force_kj_mol_nm", run.minimise, "with run.minimise = true", {"minimise"});
  table.require_effect("trajectory", run.trajectory_every > 0, "with run.trajectory_every above 0",
                       {"trajectory_every"});
  if (run.trajectory_every > 0 && run.trajectory != "dcd" && !built_with_hdf5())
    table.fail("trajectory", "taut was built without HDF5 (libhdf5-dev): \"dcd\" needs none");
  table.require_effect("friction_per_ps", run.langevin(), "with run.thermostat = \"langevin\"",
                       {"thermostat"});
  table.require_effect("thermostat_ps", run.rescaling() || run.thermostat_ps == 0,
                       "with run.thermostat = \"rescaling\"", {"thermostat"});
  if (run.thermostatted() && run.temperature_k == 0)
    table.fail(at_fault(table, {"temperature_k", "thermostat_ps", "thermostat"}),
               "a thermostat needs a run.temperature_k above 0");
  check_courses(table, run);
  if (run.rescaling() && run.thermostat_ps == 0)
    table.fail(at_fault(table, {"thermostat_ps", "thermostat"}),
               "rescaling needs its relaxation time, run.thermostat_ps above 0");
  read_barostat(table, run);
  table.reject_unknown();
}

void settle_pulls(const TomlTable& run, Scene& scene) {
  run.require_effect("pull_factor", !scene.terms.pulls.empty(), "with pulls");
  scene.terms.pull_factor = scene.run.pull_factor;
}

void settle_tensions(const TomlTable& run, Scene& scene) {
  const System& sys = scene.system;
  const auto one_sided = [&](int i, int j) {
    return std::ranges::any_of(
        sys.one_sided, [&](const OneSidedBond& b) { return std::minmax(b.i, b.j) == std::minmax(i, j); });
  };
  std::vector<std::array<int, 2>>& pairs = scene.run.tension_of;
  if (pairs.empty()) return;
  const BondsByAtoms bonds = bonds_by_atoms(sys);
  std::set<std::array<int, 2>> seen;
  for (std::size_t row = 0; row < pairs.size(); ++row) {
    for (int& atom : pairs[row]) {
      if (atom < -sys.atoms() || atom >= sys.atoms())
        run.fail("tension_of", row, fmt::format("there is no atom {} of {}", atom, sys.atoms()));
      if (atom < 0) atom += sys.atoms();
    }
    const int i = pairs[row][0], j = pairs[row][1];
    if (one_sided(i, j))
      run.fail("tension_of", row,
               fmt::format("a strut or rope is between {} and {}; expected a rigid bond, of which there is "
                           "the tension at every instant",
                           i, j));
    const auto bond = bonds.find(in_order(i, j));
    if (bond == bonds.end())
      run.fail("tension_of", row,
               fmt::format("no rigid bond is between {} and {}; to hold their distance give it as "
                           "molecule.NAME.bonds (build.bonds, a constraint of the System)",
                           i, j));
    pairs[row] = {sys.bonds[bond->second].i, sys.bonds[bond->second].j};
    if (!seen.insert(pairs[row]).second)
      run.fail("tension_of", row, fmt::format("{}-{} is there twice", i, j));
  }
  if (!sys.one_sided.empty())
    run.fail("tension_of", "what ropes and struts take over would be missing from it; leave the key out");
}

void settle_velocities(const TomlTable& run, bool another_start, Scene& scene) {
  const RunSettings& settings = scene.run;
  if (settings.velocities == "draw" && settings.temperature_k == 0)
    run.fail("velocities", "drawn at run.temperature_k, which is 0; give one, or run.velocities = \"keep\"");
  give_velocities(scene);
  const bool draws = scene.velocities_drawn || settings.thermostatted();
  if (run.overridden("temperature_k") || !another_start)
    run.require_effect(
        "temperature_k", draws || settings.metric_correction || settings.temperature_k == 0,
        "with a thermostat or run.velocities = \"draw\": the start has velocities, which are kept",
        {"thermostat", "thermostat_ps", "velocities", "metric_correction"});
  if (run.overridden("seed"))
    run.require_effect("seed", draws || scene.positions_drawn,
                       "where something is drawn: here positions and velocities are the start's");
}

void check_barostat(const TomlTable& run, const Scene& scene) {
  if (scene.run.barostat == "none") return;
  if (!scene.run.thermostatted())
    run.fail("barostat", "a barostat needs a thermostat: run.thermostat = \"langevin\" or \"rescaling\"");
  if (!scene.start.box.periodic()) run.fail("barostat", "there is no box to change; leave the key out");
  const auto& pairs = scene.terms.nonbonded;
  if (pairs && !pairs->cutoff)
    run.fail("barostat",
             "pairs without a cutoff act across no box, so that it cannot keep their pressure; give them a "
             "cutoff, or leave the key out");
  if (!pairs && !scene.terms.wca && !scene.terms.tabulated_pairs && scene.run.coupling != "isotropic")
    run.fail("coupling",
             "no pairs of atoms act across the box, so nothing holds its shape: take \"isotropic\"");
  if (!scene.closed_but_for_restraints())
    run.fail("barostat",
             "an anchored atom (mass 0), at rest or in motion, gravity, a pull, a wall or a steered atom "
             "holds on to "
             "what the box would move; leave the key out");
  if (!scene.closed() && scene.run.barostat != "monte-carlo")
    run.fail("barostat",
             "restraints hold on to what the box would move, and have no virial: take \"monte-carlo\"");
}

}  // namespace taut
