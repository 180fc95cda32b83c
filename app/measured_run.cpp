#include "measured_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/errors.hpp"
#include "base/series.hpp"
#include "files/dcd_file.hpp"
#include "files/h5md_file.hpp"
#include "files/h5md_reader.hpp"
#include "printing.hpp"
#include "simulation/checkpoint.hpp"
#include "simulation/log_columns.hpp"
#include "words.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

constexpr double kSameTime = 1e-6;  // [ps]; DCD keeps the time of a frame in single precision

// A trajectory is read in double precision where there is a choice.
std::optional<fs::path> trajectory_of(const fs::path& folder) {
  if (const fs::path file = folder / "trajectory.h5md"; built_with_hdf5() && fs::exists(file)) return file;
  if (const fs::path file = folder / "trajectory.dcd"; fs::exists(file)) return file;
  return {};
}

// Without an error where the samples are too few to tell it.
Estimate mean_with_error(const std::vector<double>& y) {
  const Estimate plain = correlated_mean(y);
  return plain.error > 0 ? mean_of_run(y) : plain;
}

// The row from which on a column stays the same; 0 where there is none.
std::size_t steady_from(const std::vector<double>& y) {
  const auto alike = [&](double value) {
    return value == y.back() || (std::isnan(value) && std::isnan(y.back()));
  };
  std::size_t row = y.size();
  while (row > 0 && alike(y[row - 1])) --row;
  return row;
}

// Calls use(reader) with a reader of the trajectory.
void with_reader(const fs::path& path, const auto& use) {
  if (path.extension() == ".dcd") {
    DcdReader file(path);
    use(file);
  } else {
    H5mdReader file(path);
    use(file);
  }
}

double time_of(const auto& file, long frame) {
  return file.first_time() + static_cast<double>(frame) * file.interval();
}

// What is later than this is in a window that begins then.
double just_before(double begin) {
  return begin - kSameTime * std::max(1.0, begin);
}

// Calls see(x, box, interval) for every frame of a file that wanted(time, interval) asks for.
void for_each_frame(const Scene& scene, const fs::path& path, const auto& wanted, const auto& see) {
  with_reader(path, [&](auto& file) {
    if (file.atoms() != scene.system.atoms())
      throw InputError(fmt::format("{}: its trajectory has {} atoms, its scene {}", path.string(),
                                   file.atoms(), scene.system.atoms()));
    Vectors x;
    Box box = scene.start.box;
    for (long frame = 0, frames = file.frames(); frame < frames; ++frame)
      if (!wanted(time_of(file, frame), file.interval()))
        file.skip();
      else if (file.next(x, box))
        see(x, box, file.interval());
  });
}

}  // namespace

MeasuredRun::MeasuredRun(std::vector<fs::path> segments, const MeasureSettings& settings)
    : segments_(std::move(segments)) {
  for (const fs::path& folder : segments_) {
    expect_checkpoint(folder);
    const RunLog log = read_log(folder);
    const double begin = log.column(kLogTime).front();
    const double end = log_.rows() == 0 ? begin : log_.column(kLogTime).back();
    shifts_.push_back(begin < end ? end - begin : 0);
    log_.append(log);
  }
  scene_ = std::make_unique<Scene>(load_checkpoint(segments_.front()).source.read());
  choose_window(settings);
  measure_log();
  measure_frames(settings);
}

void MeasuredRun::choose_window(const MeasureSettings& settings) {
  const std::vector<double>& t = log_.column(kLogTime);
  double from = settings.from.value_or(t.front());
  if (settings.last) from = t.back() - *settings.last;
  std::string why;
  automatic_ = settings.automatic;
  if (automatic_) {
    std::size_t row = 0;
    for (const std::string_view column : {kLogPotential, kLogVolume})
      if (log_.has(column)) row = std::max(row, equilibration_end(log_.column(column)));
    why = fmt::format("; equilibrated from there on by Chodera's rule (most independent samples of energy{})",
                      log_.has(kLogVolume) ? " and volume" : "");
    if (row > t.size() / 2)
      why += "; more than half is left out: the run is short beside its slow changes, or settles late";
    if (const std::size_t steady = steady_from(log_.column(kLogBath)); steady > t.size() * 9 / 10)
      why += "; the bath's temperature changes in it";
    else if (steady > row) {
      row = steady;
      why = "; the bath's temperature is the same from there on";
    }
    from = t[row];
  }
  first_row_ = static_cast<std::size_t>(std::ranges::lower_bound(t, from - kSameTime) - t.begin());
  if (first_row_ == t.size())
    throw InputError(
        fmt::format("{}: nothing from {:g} ps on: the log ends at {:g} ps", name(), from, t.back()));
  window_words_ =
      fmt::format("{} of the log from {:.6g} to {:.6g} ps{}",
                  counted(static_cast<long>(t.size() - first_row_), "row"), t[first_row_], t.back(), why);
}

std::vector<double> MeasuredRun::window_of(std::string_view column) const {
  const std::vector<double>& all = log_.column(column);
  std::vector<double> window;
  for (std::size_t row = first_row_; row < all.size(); ++row)
    if (!std::isnan(all[row])) window.push_back(all[row]);
  return window;
}

void MeasuredRun::measure_log() {
  struct Asked {
    std::string_view column;
    const char *key, *words, *unit;
  };
  for (const Asked& asked : {Asked{kLogTemperature, "temperature_k", "temperature", "K"},
                             Asked{kLogPotential, "potential_kj_mol", "potential energy", "kJ/mol"},
                             Asked{kLogTotal, "total_kj_mol", "total energy", "kJ/mol"},
                             Asked{kLogPressure, "pressure_bar", "pressure", "bar"},
                             Asked{kLogVolume, "volume_nm3", "volume", "nm³"},
                             Asked{kLogDensity, "density_kg_m3", "density", "kg/m³"}})
    if (const std::vector<double> y = window_of(asked.column); !y.empty()) {
      const bool fixed = std::ranges::all_of(y, [&](double value) { return value == y[0]; });
      if (fixed && asked.column != kLogTemperature && asked.column != kLogTotal)
        continue;  // no barostat, no forces
      log_figures_.push_back({asked.key, asked.words, asked.unit, mean_with_error(y)});
    }
  for (const auto& [title, key, words, unit] : further_columns(*scene_))
    if (const std::vector<double> y = window_of(title); !y.empty() && title != kLogSteeringWork)
      log_figures_.push_back({key, words, unit, mean_with_error(y)});
  if (!log_.has(kLogPressure)) return;
  StressSeries stress{.pressure = {},
                      .interval = log_.interval(),
                      .volume = correlated_mean(window_of(kLogVolume)).value,
                      .temperature = correlated_mean(window_of(kLogTemperature)).value};
  for (std::size_t k = 0; k < 6; ++k)
    stress.pressure[k] =
        window_of(fmt::format("Pressure {} (bar)", std::array{"XX", "YY", "ZZ", "XY", "XZ", "YZ"}[k]));
  green_kubo_ = green_kubo(stress);
  if (green_kubo_->flaw.empty())
    log_figures_.push_back({"viscosity_mpa_s", "viscosity", "mPa s", green_kubo_->viscosity});
}

// Of so many frames from `begin` on one is read, so that there are at most most_frames.
long MeasuredRun::stride_for(double begin, long most_frames) const {
  long frames = 0;
  for (std::size_t k = 0; most_frames > 0 && k < segments_.size(); ++k)
    if (const auto path = trajectory_of(segments_[k]))
      with_reader(*path, [&](const auto& file) {
        for (long frame = 0, all = file.frames(); frame < all; ++frame)
          frames += time_of(file, frame) + shifts_[k] >= just_before(begin);
      });
  return frames > 0 ? (frames + most_frames - 1) / most_frames : 1;
}

void MeasuredRun::measure_frames(const MeasureSettings& settings) {
  const double begin = log_.column(kLogTime)[first_row_];
  stride_ = stride_for(begin, settings.most_frames);
  double seen = -std::numeric_limits<double>::infinity();
  long passed = 0;
  for (std::size_t k = 0; k < segments_.size(); ++k) {
    const std::optional<fs::path> path = trajectory_of(segments_[k]);
    if (!path) {
      no_frames_ = fmt::format(
          "{}: no trajectory; for distances, diffusion and chains run with --set "
          "run.trajectory_every=100",
          segments_[k].string());
      if (!settings.atoms.empty() || settings.viscosity) throw InputError(no_frames_);
      return;
    }
    const auto wanted = [&](double t, double interval) {
      t += shifts_[k];
      if (t < just_before(begin) || t < seen + interval / 2) return false;
      seen = t;
      return passed++ % stride_ == 0;
    };
    const auto see = [&](const Vectors& x, const Box& box, double interval) {
      if (!frames_) frames_.emplace(*scene_, settings.atoms, interval * static_cast<double>(stride_));
      frames_->add_frame(x, box);
    };
    for_each_frame(*scene_, *path, wanted, see);
  }
  if (!frames_) {
    no_frames_ = fmt::format("{}: no frame from {:g} ps on", name(), begin);
    return;
  }
  const Estimate temperature = correlated_mean(window_of(kLogTemperature));
  if (settings.viscosity)
    frames_->set_viscosity({*settings.viscosity, 0}, temperature.value);
  else if (green_kubo_ && green_kubo_->flaw.empty())
    frames_->set_viscosity(green_kubo_->viscosity, temperature.value);
}

std::vector<Figure> MeasuredRun::figures() const {
  std::vector<Figure> all = log_figures_;
  if (frames_) std::ranges::copy(frames_->figures(), std::back_inserter(all));
  return all;
}

void MeasuredRun::print() const {
  say("{}: {}\n", name(), window_words_);
  say_text(figures_table(log_figures_));
  if (green_kubo_ && green_kubo_->flaw.empty())
    say("  viscosity by Green and Kubo, the pressure's correlation integrated to {:.4g} ps\n",
        green_kubo_->cut);
  else if (green_kubo_)
    say("  no viscosity: {}\n", green_kubo_->flaw);
  if (stride_ > 1) say("of {} frames one is read\n", stride_);
  if (frames_)
    frames_->print();
  else
    say("{}\n", no_frames_);
}

nlohmann::ordered_json MeasuredRun::json() const {
  const std::vector<double>& t = log_.column(kLogTime);
  nlohmann::ordered_json json = {{"run", name()},
                                 {"scene", scene_->name},
                                 {"from_ps", t[first_row_]},
                                 {"to_ps", t.back()},
                                 {"rows", t.size() - first_row_}};
  for (const Figure& figure : log_figures_) json[figure.key] = json_of(figure);
  if (green_kubo_ && !green_kubo_->flaw.empty()) json["viscosity_flaw"] = green_kubo_->flaw;
  if (stride_ > 1) json["one_frame_of"] = stride_;
  if (frames_)
    json.update(frames_->json());
  else
    json["frames"] = 0;
  return json;
}

// What is left out and what is measured, in means of neighbouring rows where there are many.
Picture MeasuredRun::equilibration_picture() const {
  constexpr std::size_t kPoints = 1000;
  const std::vector<double>&t = log_.column(kLogTime), &y = log_.column(kLogPotential);
  const std::size_t rows = std::max<std::size_t>(1, t.size() / kPoints);
  std::string csv = "t_ps,left_out_kj_mol,measured_kj_mol\n";
  for (std::size_t at = 0; at + rows <= t.size(); at += rows) {
    const double mean = std::accumulate(&y[at], &y[at] + rows, 0.0) / static_cast<double>(rows);
    csv += fmt::format("{:.6g},{}{:.9g}{}\n", t[at], at < first_row_ ? "" : ",", mean,
                       at < first_row_ ? "," : "");
  }
  return {"equilibration",
          fmt::format("{}: potential energy, measured from {:.4g} ps on", name(), t[first_row_]), csv};
}

std::vector<Picture> MeasuredRun::pictures(const std::string& curve) const {
  std::vector<Picture> all;
  if (automatic_ && log_.has(kLogPotential)) all.push_back(equilibration_picture());
  if (frames_) std::ranges::copy(frames_->pictures(curve), std::back_inserter(all));
  if (!green_kubo_ || green_kubo_->t.empty()) return all;
  std::string csv = "t_ps,correlation,correlation_error,viscosity_mpa_s,standard_error,cut_ps\n";
  for (std::size_t k = 0; k < green_kubo_->t.size(); ++k)
    csv += fmt::format("{:.6g},{:.6g},{:.2g},{:.6g},{:.2g},{:.6g}\n", green_kubo_->t[k],
                       green_kubo_->correlation[k].value, green_kubo_->correlation[k].error,
                       green_kubo_->integral[k].value, green_kubo_->integral[k].error, green_kubo_->cut);
  all.push_back(
      {"viscosity", scene_->name + ": pressure's correlation, and its integral, the viscosity", csv});
  return all;
}

}  // namespace taut
