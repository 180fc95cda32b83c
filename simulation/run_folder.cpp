#include "run_folder.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/errors.hpp"
#include "files/atomic_file.hpp"
#include "files/folder.hpp"
#include "systems/scene/start_file.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr const char* kLog = "log.csv";

// Of each type of molecule; classes without degrees of freedom are left out.
ordered_json temperatures_json(const Temperatures& temperatures) {
  ordered_json object;
  for (std::size_t type = 0; type < temperatures.types().size(); ++type)
    for (int motion = 0; motion < 3; ++motion)
      if (temperatures.types()[type].dof[motion] > 0.5)
        object[temperatures.types()[type].name][kMotionNames[motion]] =
            json_of(temperatures.temperature(static_cast<int>(type), MotionClass(motion)));
  return object;
}

ordered_json timings_json(const Timings& timings) {
  ordered_json parts;
  for (const PartTime& part : timings.parts)
    parts[name_of(part.part)] = {
        {"calls", part.calls},
        {"ms_per_step", timings.ms_a_step(part.seconds)},
        {"percent", timings.percent(part.seconds)},
        {"waiting_percent", timings.waiting_percent(part)},
    };
  return {{"steps", timings.steps},
          {"threads", timings.threads},
          {"ms_per_step", timings.ms_a_step(timings.seconds())},
          {"parts", parts}};
}

}  // namespace

ordered_json json_of(const Estimate& e) {
  return {{"value", e.value}, {"error", e.error > 0 ? ordered_json(e.error) : ordered_json()}};
}

ordered_json summary_json(const Simulation& simulation, const Summary& s) {
  const Scene& scene = simulation.scene();
  ordered_json object = {
      {"scene", scene.name},
      {"method", scene.method.name()},
      {"atoms", scene.system.atoms()},
      {"bonds", scene.system.bond_count()},
      {"dof", simulation.dof().total()},
      {"steps", s.steps},
      {"dt_fs", scene.run.dt_fs},
      {"us_per_step", s.us_per_step},
      {"constraint_us_per_step", s.constraint_us_per_step},
      {"ns_per_day", s.ns_per_day},
      {"max_rel_bond_error", s.max_rel_bond_error},
      {"rms_rel_bond_error", s.rms_rel_bond_error},
      {"energy_drift_kj_mol_ns_dof", s.drift.value},
      {"energy_drift_standard_error", s.drift.error > 0 ? ordered_json(s.drift.error) : ordered_json()},
      {"constraint_drift_kj_mol_ns_dof", s.constraint_drift.value},
      {"constraint_work_kj_mol", s.constraint_work},
      {"heat_kj_mol", s.heat ? ordered_json(*s.heat) : ordered_json()},
      {"temperature_k", s.temperature},
      {"potential_kj_mol", s.potential},
      {"total_kj_mol", s.total},
      {"converged", s.converged ? ordered_json(*s.converged) : ordered_json()},
      {"doubts", s.doubts},
      {"method_setting", simulation.method().setting()},
      {"seed", scene.run.seed},
      {"temperatures_k", temperatures_json(simulation.temperatures())},
  };
  if (!s.timings.parts.empty()) object["timings"] = timings_json(s.timings);
  for (const Estimate& wall : s.walls)
    object[s.pressure ? "wall_pressures_bar" : "wall_forces_kj_mol_nm"].push_back(json_of(wall));
  if (s.tension) object["tension_kj_mol_nm"] = json_of(*s.tension);
  if (s.steering_work) object["steering_work_kj_mol"] = *s.steering_work;
  for (std::size_t b = 0; b < s.biases.size(); ++b) {
    const Bias& bias = scene.terms.biases[b];
    const auto [value, force] = columns_of(bias, b);
    object[value.key] = json_of(s.biases[b].value);
    object[force.key] = json_of(s.biases[b].force);
  }
  if (!s.pressure) return object;
  object["pressure_bar"] = json_of(*s.pressure);
  object["volume_nm3"] = json_of(s.volume);
  object["density_kg_m3"] = json_of(s.density);
  for (std::size_t k = 0; k < kTensorNames.size(); ++k)
    object["pressure_tensor_bar"][kTensorNames[k]] = json_of(s.pressure_tensor[k]);
  return object;
}

namespace {

ordered_json failure_json(const Diagnosis& d) {
  ordered_json object = {{"step", d.step}, {"time_ps", d.t}, {"cause", d.cause}, {"try", d.advice}};
  if (d.bond >= 0)
    object["bond"] = {{"index", d.bond},
                      {"atoms", {d.held.i, d.held.j}},
                      {"length_nm", d.length},
                      {"length_before_nm", d.length_before},
                      {"target_nm", d.held.length}};
  object["largest_force"] = {{"kj_mol_nm", d.largest_force}, {"atom", d.atom}};
  object["last_good_frame"] = {{"file", "last_good.start.toml"}, {"step", d.step - 1}};
  return object;
}

// A name that is not UTF-8 is written with U+FFFD in place of what cannot be read.
void write_json_file(const fs::path& path, const ordered_json& object) {
  write_file(path, object.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n");
}

// Moves aside what an earlier run wrote: it is another run's, or of an earlier step. The checkpoint goes
// first: without it nobody takes the rest for a run that can go on. Returns a sentence that says so, or
// nothing.
std::string clear(const fs::path& folder, const Simulation& simulation, const Marks& marks) {
  std::vector<std::string> old;
  if (marks.empty()) {
    old = run_files(folder);
  } else {
    std::vector<std::string> unmarked;
    auto outputs = Trajectories::extents(folder, simulation);
    outputs.emplace(kLog, 0);
    for (const auto& [name, extent] : outputs)
      if (!marks.contains(name)) unmarked.insert(unmarked.end(), {name, name + ".journal"});
    old = list_present(folder, unmarked);
  }
  if (old.empty()) return "";
  return fmt::format("{}: what was there is kept in {}", folder.string(),
                     move_to_backup(folder, old).string());
}

std::uint64_t mark_of(const Marks& marks, const std::string& name) {
  const auto mark = marks.find(name);
  return mark == marks.end() ? 0 : mark->second;
}

}  // namespace

RunFolder::RunFolder(FolderLock folder, SceneSource source, const Simulation& simulation, const Marks& marks)
    : folder_(std::move(folder)),
      note_(clear(path(), simulation, marks)),
      checkpoint_{.source = std::move(source)},
      log_(path() / kLog, mark_of(marks, kLog)),
      columns_(columns_of_file(simulation.scene())),
      trajectories_(path(), simulation, marks) {
  if (log_.size() == 0) log_.write(header_of(columns_));
  if (marks.empty()) return;
  kept_step_ = simulation.step();
  kept_marks_ = marks;
  std::error_code ignored;
  for (const char* name : {"summary.json", "final.start.toml", "failure.json", "last_good.start.toml"})
    fs::remove(path() / name, ignored);  // they are of a step that is not the last any more
}

void RunFolder::begin(Simulation& simulation) {
  if (simulation.step() == 0) add_frame(simulation);
  keep(simulation);
}

void RunFolder::add_row(const Record& record) {
  log_.write(row_of(columns_, record));
}

void RunFolder::add_frame(const Simulation& simulation) {
  if (trajectories_.due(simulation.step())) trajectories_.add(simulation, simulation.step());
}

void RunFolder::keep(Simulation& simulation) {
  checkpoint_.step = simulation.step();
  checkpoint_.t = simulation.state().t;
  checkpoint_.threads = simulation.threads();
  checkpoint_.marks = {{kLog, log_.mark()}};
  trajectories_.mark(checkpoint_.marks);
  checkpoint_.memory.clear();
  Archive archive = Archive::saving_to(checkpoint_.memory);
  simulation.serialize(archive);
  write_checkpoint(path(), checkpoint_);
  std::string().swap(checkpoint_.memory);  // it is as large as the system: gives the memory back
  kept_step_ = checkpoint_.step;
  kept_marks_ = checkpoint_.marks;
}

std::vector<std::string> RunFolder::outgrown(const Simulation& simulation) const {
  return find_outputs(path(), simulation, kept_marks_).longer;
}

void RunFolder::write_end(const Simulation& simulation, const Summary& summary) {
  log_.mark();
  write_start(path() / "final.start.toml", simulation.state_to_write());
  write_json_file(path() / "summary.json", summary_json(simulation, summary));
}

void RunFolder::write_failure(const Simulation& simulation, const Diagnosis& diagnosis) {
  log_.mark();
  write_start(path() / "last_good.start.toml", simulation.state_to_write());
  write_json_file(path() / "failure.json", failure_json(diagnosis));
}

std::vector<std::string> run_files(const fs::path& folder) {
  return list_present(
      folder, {"checkpoint.cbor", kLog, "trajectory.dcd", "trajectory.h5md", "trajectory.h5md.journal",
               "start.pdb", "summary.json", "final.start.toml", "failure.json", "last_good.start.toml"});
}

OutputsFound find_outputs(const fs::path& folder, const Simulation& simulation, const Marks& marks) {
  OutputsFound found;
  auto outputs = Trajectories::extents(folder, simulation);
  outputs[kLog] = size_of(folder / kLog);
  for (const auto& [name, extent] : outputs) {
    const std::uint64_t mark = mark_of(marks, name);
    if (extent < mark || (extent == 0 && name == kLog)) found.missing.push_back(name);
    if (mark > 0 && extent / 2 > mark) found.longer.push_back(name);
  }
  return found;
}

}  // namespace taut
