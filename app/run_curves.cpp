#include "run_curves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "files/h5md_file.hpp"
#include "files/h5md_reader.hpp"
#include "simulation/log_columns.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;
using Use = LogColumn::Use;

// Adds what a row of the log has, row by row; rows without it are left out.
void add(std::vector<Curve>& curves, const RunLog& log, Curve curve, const std::vector<double>& y) {
  const std::vector<double>& t = log.column("time_ps");
  for (std::size_t row = 0; row < y.size(); ++row) {
    if (std::isnan(y[row])) continue;
    curve.t.push_back(t[row]);
    curve.y.push_back(y[row]);
  }
  if (!curve.y.empty()) curves.push_back(std::move(curve));
}

// Adds what the run's account has: the energy less what came from outside, and what the bonds did, from the start on.
void add_account(std::vector<Curve>& curves, const RunLog& log, const std::vector<LogColumn>& columns,
                 const std::string& of) {
  std::vector<double> energy = log.column("total_kj_mol"), bonds = log.column("constraint_work_kj_mol");
  std::string name = "energy but for the heat";
  for (const LogColumn& column : columns) {
    const bool steering = column.key == "steering_work_kj_mol";
    if (!steering && column.key != "heat_kj_mol") continue;
    if (steering) name = "energy but for heat and steering";
    const std::vector<double>& less = log.column(column);
    for (std::size_t row = 0; row < std::min(energy.size(), less.size()); ++row)
      if (!std::isnan(less[row])) energy[row] -= less[row];
  }
  for (std::vector<double>* y : {&energy, &bonds}) {
    if (!y->empty())
      for (const double first = y->front(); double& value : *y) value -= first;
    add(curves, log,
        {.panel = "energy's account [kJ/mol]",
         .name = of + (y == &energy ? name : "what the bonds did"),
         .t = {},
         .y = {}},
        *y);
  }
}

std::string panel_of(const LogColumn& column) {
  return column.words + (column.unit.empty() ? "" : fmt::format(" [{}]", column.unit));
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
    const double t = frames.time_of(frame);
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

}  // namespace

std::vector<Curve> curves_of(const RunLog& log, const std::string& run, const Scene* scene,
                             const fs::path& folder, long most_frames) {
  const std::string of = run.empty() ? "" : run + ": ";
  const std::string alone = run.empty() ? "each row" : run;
  std::vector<Curve> all;
  const std::vector<LogColumn> columns = scene ? log_columns(*scene) : common_columns();
  for (const LogColumn& column : columns) {
    const std::vector<double>& y = log.column(column);
    if (column.key == "total_kj_mol") {
      add_account(all, log, columns, of);
      continue;
    }
    const bool has_mean = column.use == Use::kMean || column.use == Use::kMeanWhereItVaries;
    const bool still_drawn =
        has_mean && !column.of_box && !y.empty() && y.front() != 0;  // where it is constant
    if (column.use != Use::kNone && (still_drawn || varies(y)))
      add(all, log,
          {.panel = panel_of(column),
           .name = alone,
           .t = {},
           .y = {},
           .running_mean = has_mean,
           .key = column.key},
          y);
    if (column.key == "temperature_k")
      add(all, log, {.panel = panel_of(column), .name = of + "bath", .t = {}, .y = {}},
          log.column("bath_temperature_k"));
  }
  add_tensions(all, folder, of, most_frames);
  return all;
}

}  // namespace taut
