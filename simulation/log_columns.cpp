#include "simulation/log_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace taut {
namespace {

using Use = LogColumn::Use;

auto tensor(std::size_t k) {
  return [k](const Record& r) { return r.pressure ? six_of(r.pressure_tensor)[k] : kUnknown; };
}

}  // namespace

// OpenMM's StateDataReporter's columns, then ours.
const std::vector<LogColumn>& common_columns() {
  using R = const Record&;
  static const std::vector<LogColumn> kColumns = {
      // clang-format off
      {"Step", "step", "steps taken", "", [](R r) { return static_cast<double>(r.step); }, {"step", 8, ""}},
      {"Time (ps)", "time_ps", "time", "ps", [](R r) { return r.t; }, {"t", 10, ".4f"}},
      {"Potential Energy (kJ/mole)", "potential_kj_mol", "potential energy", "kJ/mol", [](R r) { return r.potential; }, {"E_pot", 12, ".6g"}, Use::kMeanWhereItVaries},
      {"Kinetic Energy (kJ/mole)", "kinetic_kj_mol", "kinetic energy", "kJ/mol", [](R r) { return r.kinetic; }},
      {"Total Energy (kJ/mole)", "total_kj_mol", "total energy", "kJ/mol", [](R r) { return r.total(); }, {"E_total", 12, ".8g"}, Use::kMean},
      {"Temperature (K)", "temperature_k", "temperature", "K", [](R r) { return r.temperature; }, {"T", 8, ".2f"}, Use::kMean},
      {"Speed (ns/day)", "ns_per_day", "speed", "ns/day", [](R r) { return r.ns_per_day; }},
      {"Max Relative Bond Error", "max_rel_bond_error", "largest relative error of a rigid bond", "", [](R r) { return r.bonds.max; }, {"bond err", 9, ".1e"}},
      {"RMS Relative Bond Error", "rms_rel_bond_error", "relative bond error (rms)", "", [](R r) { return r.bonds.rms; }, {}, Use::kDrawn},
      {"Energy Drift (kJ/mole/ns/dof)", "drift_kj_mol_ns_dof", "trend of the energy less the heat so far", "kJ/mol/ns/degree of freedom", [](R r) { return r.drift; }},
      {"Iterations per Step", "iterations", "iterations of the method per step since the last row", "", [](R r) { return r.iterations; }, {"iter", 5, ".3g"}},
      {"Pressure (bar)", "pressure_bar", "pressure", "bar", [](R r) { return r.pressure.value_or(kUnknown); }, {"P", 8, ".1f"}, Use::kMeanWhereItVaries, true},
      {"Constraint Work (kJ/mole)", "constraint_work_kj_mol", "what the bonds changed the energy by since the start", "kJ/mol", [](R r) { return r.constraint_work; }},
      {"Heat (kJ/mole)", "heat_kj_mol", "heat from thermostat and barostat since the start", "kJ/mol", [](R r) { return r.heat.value_or(kUnknown); }},
      {"Full-Step Temperature (K)", "full_step_temperature_k", "temperature of the full step's velocities", "K", [](R r) { return r.full_step_temperature; }},
      {"Bath Temperature (K)", "bath_temperature_k", "temperature of the thermostat", "K", [](R r) { return r.bath_temperature.value_or(kUnknown); }},
      {"Box Volume (nm^3)", "volume_nm3", "volume", "nm³", [](R r) { return r.pressure ? r.volume : kUnknown; }, {}, Use::kMeanWhereItVaries, true},
      {"Density (kg/m^3)", "density_kg_m3", "density", "kg/m³", [](R r) { return r.pressure ? r.density : kUnknown; }, {}, Use::kMeanWhereItVaries, true},
      {"Pressure XX (bar)", "pressure_xx_bar", "pressure tensor, xx", "bar", tensor(0), {}, Use::kNone, true},
      {"Pressure YY (bar)", "pressure_yy_bar", "pressure tensor, yy", "bar", tensor(1), {}, Use::kNone, true},
      {"Pressure ZZ (bar)", "pressure_zz_bar", "pressure tensor, zz", "bar", tensor(2), {}, Use::kNone, true},
      {"Pressure XY (bar)", "pressure_xy_bar", "pressure tensor, xy", "bar", tensor(3), {}, Use::kNone, true},
      {"Pressure XZ (bar)", "pressure_xz_bar", "pressure tensor, xz", "bar", tensor(4), {}, Use::kNone, true},
      {"Pressure YZ (bar)", "pressure_yz_bar", "pressure tensor, yz", "bar", tensor(5), {}, Use::kNone, true},
      // clang-format on
  };
  return kColumns;
}

const LogColumn& common_column(std::string_view key) {
  const auto at = std::ranges::find(common_columns(), key, &LogColumn::key);
  if (at == common_columns().end()) throw std::out_of_range(fmt::format("no column {}", key));
  return *at;
}

std::array<LogColumn, 2> columns_of(const Bias& bias, std::size_t number) {
  const std::string key = "bias_" + bias.name, title = "Bias " + bias.name, words = "bias " + bias.name;
  const char* unit = bias.angular() ? "rad" : "nm";
  return {LogColumn{.title = title + (bias.angular() ? " (degree)" : " (nm)"),
                    .key = key + (bias.angular() ? "_deg" : "_nm"),
                    .words = fmt::format("{}: {}", words, name_of(bias.variable)),
                    .unit = bias.angular() ? "°" : "nm",
                    .of = [number](const Record& r) { return r.biases[number].value; },
                    .use = Use::kMean},
          LogColumn{.title = fmt::format("{} Force (kJ/mole/{})", title, unit),
                    .key = fmt::format("{}_force_kj_mol_{}", key, unit),
                    .words = words + ": force",
                    .unit = fmt::format("kJ/mol/{}", unit),
                    .of = [number](const Record& r) { return r.biases[number].force; },
                    .use = Use::kMean}};
}

std::array<LogColumn, 2> columns_of_held(const RunSettings& run) {
  const std::size_t bonds = run.tension_of.size();
  const std::string of = bonds == 1
                             ? fmt::format("tension of {}-{}", run.tension_of[0][0], run.tension_of[0][1])
                             : fmt::format("mean tension of {} bonds", bonds);
  return {LogColumn{.title = "Tension (kJ/mole/nm)",
                    .key = "tension_kj_mol_nm",
                    .words = of,
                    .unit = "kJ/mol/nm",
                    .of = [](const Record& r) { return r.held ? r.held->tension : kUnknown; },
                    .use = Use::kMean},
          LogColumn{.title = "Metric Weight",
                    .key = "metric_weight",
                    .words = "metric weight of run.tension_of",
                    .unit = run.metric_correction ? "nm" : "u^½",
                    .of = [](const Record& r) { return r.held ? r.held->weight : kUnknown; }}};
}

std::vector<LogColumn> log_columns(const Scene& scene) {
  std::vector<LogColumn> columns = common_columns();
  const bool in_box = scene.start.box.periodic();
  for (std::size_t w = 0; w < scene.terms.walls.size(); ++w)
    columns.push_back(
        {.title = fmt::format("Wall {} {}", w, in_box ? "Pressure (bar)" : "Force (kJ/mole/nm)"),
         .key = fmt::format("wall_{}_{}", w, in_box ? "pressure_bar" : "force_kj_mol_nm"),
         .words = fmt::format("{} on wall {}", in_box ? "pressure" : "force", w),
         .unit = in_box ? "bar" : "kJ/mol/nm",
         .of = [w](const Record& r) { return r.walls[w]; },
         .use = Use::kMean});
  if (scene.terms.worked_in_time() || !scene.motions.empty())
    columns.push_back({.title = "Steering Work (kJ/mole)",
                       .key = "steering_work_kj_mol",
                       .words = "steering work",
                       .unit = "kJ/mol",
                       .of = [](const Record& r) { return r.steering_work.value_or(kUnknown); },
                       .use = Use::kDrawn});
  if (scene.terms.steered_in_time())
    columns.push_back({.title = "Steering Force (kJ/mole/nm)",
                       .key = "steering_force_kj_mol_nm",
                       .words = "steering force",
                       .unit = "kJ/mol/nm",
                       .of = [](const Record& r) { return r.steering_force.value_or(kUnknown); },
                       .use = Use::kMean});
  for (std::size_t m = 0; m < scene.motions.size(); ++m)
    columns.push_back({.title = fmt::format("Motion {} Power (kJ/mole/ps)", m),
                       .key = fmt::format("motion_{}_power_kj_mol_ps", m),
                       .words = fmt::format("power of motion {}", m),
                       .unit = "kJ/mol/ps",
                       .of = [m](const Record& r) { return r.motions[m]; },
                       .use = Use::kMean});
  for (std::size_t b = 0; b < scene.terms.biases.size(); ++b)
    std::ranges::copy(columns_of(scene.terms.biases[b], b), std::back_inserter(columns));
  if (!scene.run.tension_of.empty())
    std::ranges::copy(columns_of_held(scene.run), std::back_inserter(columns));
  return columns;
}

std::vector<LogColumn> columns_of_file(const Scene& scene) {
  std::vector<LogColumn> columns = log_columns(scene);
  if (!scene.start.box.periodic()) std::erase_if(columns, [](const LogColumn& c) { return c.of_box; });
  return columns;
}

std::string header_of(const std::vector<LogColumn>& columns) {
  std::string header;
  for (const LogColumn& column : columns)
    header += fmt::format("{}\"{}\"", header.empty() ? "#" : ",", column.title);
  return header + "\n";
}

std::string row_of(const std::vector<LogColumn>& columns, const Record& record) {
  std::string row;
  for (const LogColumn& column : columns) {
    if (!row.empty()) row += ',';
    if (const double value = column.of(record); !std::isnan(value)) row += fmt::format("{}", value);
  }
  return row + "\n";
}

}  // namespace taut
