#include "run_curves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "files/h5md_file.hpp"
#include "files/h5md_reader.hpp"
#include "simulation/log_columns.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

// Adds what a row of the log has, row by row; rows without it are left out.
void add(std::vector<Curve>& curves, const RunLog& log, const Curve& as, const std::vector<double>& y) {
  Curve curve = as;
  for (std::size_t row = 0; row < y.size(); ++row) {
    if (std::isnan(y[row])) continue;
    curve.t.push_back(log.column(kLogTime)[row]);
    curve.y.push_back(y[row]);
  }
  if (!curve.y.empty()) curves.push_back(std::move(curve));
}

void add(std::vector<Curve>& curves, const RunLog& log, const Curve& as, std::string_view column) {
  add(curves, log, as, log.column(column));
}

// Adds what the energy's account has of a column: what it is less others, from the start on.
void add_account(std::vector<Curve>& curves, const RunLog& log, const std::string& name,
                 std::string_view column, std::initializer_list<std::string_view> less = {}) {
  std::vector<double> y = log.column(column);
  for (const std::string_view other : less)
    for (std::size_t row = 0; row < y.size() && log.has(other); ++row)
      if (const double value = log.column(other)[row]; !std::isnan(value)) y[row] -= value;
  if (!y.empty())
    for (const double first = y.front(); double& value : y) value -= first;
  add(curves, log, {.panel = "energy's account [kJ/mol]", .name = name, .t = {}, .y = {}}, y);
}

bool varies(const std::vector<double>& y) {
  return std::ranges::any_of(y, [&](double value) { return value != y.front(); });
}

// The mean tension of the bonds and the largest, of at most so many frames of trajectory.h5md; 0: of all.
void add_tensions(std::vector<Curve>& curves, const fs::path& folder, const std::string& of,
                  long most_frames) {
  const fs::path file = folder / "trajectory.h5md";
  if (!built_with_hdf5() || !fs::exists(file)) return;
  H5mdReader frames(file);
  Curve mean{.panel = "bond tension [kJ/mol/nm]", .name = of + "mean", .t = {}, .y = {}}, most = mean;
  most.name = of + "largest";
  const long stride = most_frames > 0 ? std::max(1L, (frames.frames() + most_frames - 1) / most_frames) : 1;
  for (long frame = 0; frame < frames.frames(); ++frame) {
    frames.skip();
    if (frame % stride != 0) continue;
    const double t = frames.first_time() + static_cast<double>(frame) * frames.interval();
    const Eigen::VectorXd tension = frames.tensions();
    if (tension.size() == 0) return;
    for (Curve* curve : {&mean, &most}) curve->t.push_back(t);
    mean.y.push_back(tension.mean());
    most.y.push_back(tension.maxCoeff());
  }
  if (mean.y.empty()) return;
  curves.push_back(std::move(most));
  curves.push_back(std::move(mean));
}

// The bath's temperature: the log's where it changes in time, or else the scene's.
void add_bath(std::vector<Curve>& curves, const RunLog& log, const Scene* scene, const std::string& of) {
  const Curve bath{.panel = "temperature [K]", .name = of + "bath", .t = {}, .y = {}};
  if (log.has(kLogBath)) return add(curves, log, bath, kLogBath);
  if (!scene || !scene->run.thermostatted()) return;
  curves.push_back(bath);
  for (const double t : {log.column(kLogTime).front(), log.column(kLogTime).back()}) {
    curves.back().t.push_back(t);
    curves.back().y.push_back(scene->run.bath_temperature(t));
  }
}

}  // namespace

std::vector<Curve> curves_of(const RunLog& log, const std::string& run, const Scene* scene,
                             const fs::path& folder, long most_frames) {
  const std::string of = run.empty() ? "" : run + ": ";
  const std::string alone = run.empty() ? "each row" : run;
  std::vector<Curve> all;
  const auto curve = [](const char* panel, std::string name, bool mean) {
    return Curve{.panel = panel, .name = std::move(name), .t = {}, .y = {}, .running_mean = mean};
  };
  add(all, log, curve("potential energy [kJ/mol]", alone, true), kLogPotential);
  const bool steered = log.has(kLogSteeringWork);
  add_account(all, log, of + (steered ? "energy but for heat and steering" : "energy but for the heat"),
              kLogTotal, {kLogHeat, kLogSteeringWork});
  add_account(all, log, of + "what the bonds did", kLogConstraintWork);
  add(all, log, curve("temperature [K]", alone, true), kLogTemperature);
  add_bath(all, log, scene, of);
  add(all, log, curve("pressure [bar]", alone, true), kLogPressure);
  if (log.has(kLogVolume) && varies(log.column(kLogVolume))) {
    add(all, log, curve("volume [nm³]", alone, true), kLogVolume);
    add(all, log, curve("density [kg/m³]", alone, true), kLogDensity);
  }
  if (scene)
    for (const LogColumn& column : further_columns(*scene))
      add(all, log,
          curve(fmt::format("{} [{}]", column.words, column.unit).c_str(), alone,
                column.title != kLogSteeringWork),
          column.title);
  if (log.has(kLogBondError) && varies(log.column(kLogBondError)))
    add(all, log, curve("relative bond error (rms)", alone, false), kLogBondError);
  add_tensions(all, folder, of, most_frames);
  return all;
}

}  // namespace taut
