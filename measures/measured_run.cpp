#include "measures/measured_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/errors.hpp"
#include "base/even_times.hpp"
#include "base/series.hpp"
#include "base/words.hpp"
#include "files/dcd_file.hpp"
#include "files/h5md_file.hpp"
#include "files/h5md_reader.hpp"
#include "files/text_file.hpp"
#include "simulation/checkpoint.hpp"
#include "simulation/run_folder.hpp"

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

// The row from which on a column stays the same; 0 where there is none.
std::size_t steady_from(const std::vector<double>& y) {
  const auto alike = [&](double value) {
    return value == y.back() || (std::isnan(value) && std::isnan(y.back()));
  };
  std::size_t row = y.size();
  while (row > 0 && alike(y[row - 1])) --row;
  return row;
}

// By more than rounding, as the energy of atoms whose distances are all held does not.
bool varies(const std::vector<double>& y) {
  constexpr double kRounding = 1e-10;
  const auto [least, most] = std::ranges::minmax(y);
  return most - least > kRounding * std::max(std::abs(least), std::abs(most));
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

// What is later than this is in a window that begins then.
double just_before(double begin) {
  return begin - kSameTime * std::max(1.0, begin);
}

// Calls see(t, x, box, file) for every frame of a file that wanted(t) asks for.
void for_each_frame(const Scene& scene, const fs::path& path, const auto& wanted, const auto& see) {
  with_reader(path, [&](auto& file) {
    if (file.atoms() != scene.system.atoms())
      throw InputError(fmt::format("{}: its trajectory has {} atoms, its scene {}", path.string(),
                                   file.atoms(), scene.system.atoms()));
    Vectors x;
    Box box = scene.start.box;
    for (long frame = 0, frames = file.frames(); frame < frames; ++frame)
      if (!wanted(file.time_of(frame)))
        file.skip();
      else if (file.next(x, box))
        see(file.time_of(frame), x, box, file);
  });
}

std::string no_tensions(const fs::path& folder) {
  return fmt::format(
      "--tensions: {} has no trajectory.h5md, whose frames have the tension of each bond; run with --set "
      "run.trajectory=h5md run.trajectory_every=100{}",
      folder.string(), built_with_hdf5() ? "" : ", by a taut built with HDF5 (libhdf5-dev)");
}

// What a finished run's summary.json says of it.
std::vector<std::string> doubts_of(const fs::path& folder) {
  if (!fs::exists(folder / "summary.json")) return {};
  const auto summary = nlohmann::json::parse(contents_of(folder / "summary.json"), nullptr, false);
  return summary.is_object() ? summary.value("doubts", std::vector<std::string>{})
                             : std::vector<std::string>{};
}

}  // namespace

MeasuredRun::MeasuredRun(std::vector<fs::path> segments, const MeasureSettings& settings)
    : segments_(std::move(segments)) {
  for (const fs::path& folder : segments_) {
    expect_checkpoint(folder);
    const RunLog log = read_log(folder);
    const double begin = log.column("time_ps").front();
    const double end = log_.rows() == 0 ? begin : log_.column("time_ps").back();
    shifts_.push_back(begin < end ? end - begin : 0);
    log_.append(log);
    std::ranges::copy(doubts_of(folder), std::back_inserter(doubts_));
  }
  scene_ = std::make_unique<Scene>(load_checkpoint(segments_.front()).source.read());
  choose_window(settings);
  measure_log();
  measure_frames(settings);
}

void MeasuredRun::choose_window(const MeasureSettings& settings) {
  const std::vector<double>& t = log_.column("time_ps");
  double from = settings.from.value_or(t.front());
  if (settings.last) from = t.back() - *settings.last;
  std::string why;
  automatic_ = settings.automatic;
  if (automatic_) {
    std::size_t row = 0;
    const EvenMeans even(t);
    for (const char* key : {"potential_kj_mol", "volume_nm3"})
      if (log_.has(key) && varies(log_.column(key)))
        row = std::max(row, even.first_sample(equilibration_end(even.of(log_.column(key)))));
    why = fmt::format("; equilibrated from there on by Chodera's rule (most independent samples of energy{})",
                      log_.has("volume_nm3") ? " and volume" : "");
    if (row > t.size() / 2)
      why += "; more than half is left out: the run is short beside its slow changes, or settles late";
    if (const std::size_t steady = steady_from(log_.column("bath_temperature_k")); steady > t.size() * 9 / 10)
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

std::vector<double> MeasuredRun::rows_of(const LogColumn& column) const {
  const std::vector<double>& all = log_.column(column);
  return {all.begin() + static_cast<std::ptrdiff_t>(std::min(first_row_, all.size())), all.end()};
}

std::vector<double> MeasuredRun::window_of(const LogColumn& column) const {
  const std::vector<double> t = rows_of(common_column("time_ps")), rows = rows_of(column);
  std::vector<double> times, window;
  for (std::size_t row = 0; row < rows.size(); ++row)
    if (!std::isnan(rows[row])) times.push_back(t[row]), window.push_back(rows[row]);
  return EvenMeans(times).of(window);
}

void MeasuredRun::measure_log() {
  for (const LogColumn& column : log_columns(*scene_)) {
    const bool where_it_varies = column.use == LogColumn::Use::kMeanWhereItVaries;
    if (column.use != LogColumn::Use::kMean && !where_it_varies) continue;
    const std::vector<double> rows = rows_of(column), y = window_of(column);
    const auto first = [&](double value) { return value == rows[0]; };
    if (y.empty() || (where_it_varies && std::ranges::all_of(rows, first)))
      continue;  // no barostat, no forces
    log_figures_.push_back({column.key, column.words, column.unit, mean_with_error(y)});
  }
  if (!log_.has("pressure_bar")) return;
  StressSeries stress{.pressure = {},
                      .t = rows_of(common_column("time_ps")),
                      .volume = correlated_mean(window_of("volume_nm3")).value,
                      .temperature = correlated_mean(window_of("temperature_k")).value};
  for (std::size_t k = 0; k < kTensorNames.size(); ++k)
    stress.pressure[k] = rows_of(common_column(fmt::format("pressure_{}_bar", kTensorNames[k])));
  green_kubo_ = green_kubo(stress);
  viscosity_rows_ = said_of(green_kubo_->rows, stress.t, "row");
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
          frames += file.time_of(frame) + shifts_[k] >= just_before(begin);
      });
  return frames > 0 ? (frames + most_frames - 1) / most_frames : 1;
}

void MeasuredRun::measure_frames(const MeasureSettings& settings) {
  const double begin = log_.column("time_ps")[first_row_];
  stride_ = stride_for(begin, settings.most_frames);
  if (settings.tensions && scene_->system.bond_count() == 0)
    throw InputError(fmt::format("--tensions: {} has no rigid bonds", name()));
  if (settings.tensions) loads_.emplace(*scene_);
  double seen = -std::numeric_limits<double>::infinity();
  long passed = 0;
  for (std::size_t k = 0; k < segments_.size(); ++k) {
    const std::optional<fs::path> path = trajectory_of(segments_[k]);
    if (!path) {
      no_frames_ = fmt::format(
          "{}: no trajectory; for distances, diffusion and chains run with --set "
          "run.trajectory_every=100",
          segments_[k].string());
      if (settings.tensions) throw InputError(no_tensions(segments_[k]));
      if (!settings.atoms.empty() || settings.viscosity) throw InputError(no_frames_);
      return;
    }
    const auto wanted = [&](double t) {
      t += shifts_[k];
      if (t < just_before(begin) || just_before(t) <= seen) return false;
      seen = t;
      return passed++ % stride_ == 0;
    };
    if (settings.tensions && path->extension() == ".dcd") throw InputError(no_tensions(segments_[k]));
    const auto see = [&](double t, const Vectors& x, const Box& box, const auto& file) {
      if (!frames_) frames_.emplace(*scene_, settings.atoms);
      frames_->add_frame(t + shifts_[k], x, box);
      if constexpr (requires { file.tensions(); })
        if (loads_) loads_->add_frame(t + shifts_[k], file.tensions());
    };
    for_each_frame(*scene_, *path, wanted, see);
  }
  if (!frames_) {
    no_frames_ = fmt::format("{}: no frame from {:g} ps on", name(), begin);
    if (settings.tensions) throw InputError("--tensions: " + no_frames_);
    return;
  }
  const Estimate temperature = correlated_mean(window_of("temperature_k"));
  if (settings.viscosity)
    frames_->set_viscosity({*settings.viscosity, 0}, temperature.value);
  else if (green_kubo_ && green_kubo_->flaw.empty())
    frames_->set_viscosity(green_kubo_->viscosity, temperature.value);
}

std::optional<std::array<Figure, 2>> MeasuredRun::held() const {
  if (scene_->run.tension_of.empty()) return {};
  const std::array<LogColumn, 2> columns = columns_of_held(scene_->run);
  std::array<Figure, 2> found;
  for (std::size_t k = 0; k < found.size(); ++k) {
    const std::vector<double> y = window_of(columns[k]);
    found[k] = {columns[k].key, columns[k].words, columns[k].unit,
                y.empty() ? Estimate{kUnknown, 0} : mean_with_error(y)};
  }
  return found;
}

bool MeasuredRun::metric_weight_varies() const {
  constexpr double kTolerance = 1e-6;
  const std::vector<double> y = window_of(columns_of_held(scene_->run)[1]);
  if (y.empty()) return false;
  const auto [least, most] = std::ranges::minmax(y);
  return most - least > kTolerance * most;
}

std::vector<Figure> MeasuredRun::figures() const {
  std::vector<Figure> all = log_figures_;
  if (frames_) std::ranges::copy(frames_->figures(), std::back_inserter(all));
  return all;
}

std::string MeasuredRun::in_words() const {
  std::string text = fmt::format("{}: {}\n", name(), window_words_) + figures_table(log_figures_);
  if (green_kubo_ && green_kubo_->flaw.empty())
    text +=
        fmt::format("  viscosity by Green and Kubo, the pressure's correlation integrated to {:.4g} ps{}\n",
                    green_kubo_->cut, viscosity_rows_);
  else if (green_kubo_)
    text += fmt::format("  no viscosity: {}{}\n", green_kubo_->flaw, viscosity_rows_);
  if (stride_ > 1) text += fmt::format("of {} frames one is read\n", stride_);
  return text + (frames_ ? frames_->in_words() : no_frames_ + "\n") + (loads_ ? loads_->in_words() : "");
}

nlohmann::ordered_json MeasuredRun::json() const {
  const std::vector<double>& t = log_.column("time_ps");
  nlohmann::ordered_json json = {{"run", name()},
                                 {"scene", scene_->name},
                                 {"from_ps", t[first_row_]},
                                 {"to_ps", t.back()},
                                 {"rows", t.size() - first_row_}};
  for (const Figure& figure : log_figures_) json[figure.key] = json_of(figure.value);
  if (!doubts_.empty()) json["doubts"] = doubts_;
  if (green_kubo_ && !green_kubo_->flaw.empty()) json["viscosity_flaw"] = green_kubo_->flaw;
  if (!viscosity_rows_.empty()) json["viscosity_rows"] = green_kubo_->rows.samples.size();
  if (stride_ > 1) json["one_frame_of"] = stride_;
  if (frames_)
    json.update(frames_->json());
  else
    json["frames"] = 0;
  if (loads_) json["tensions"] = loads_->json();
  return json;
}

// What is left out and what is measured, in means of neighbouring rows where there are many.
Picture MeasuredRun::equilibration_picture() const {
  constexpr std::size_t kPoints = 1000;
  const std::vector<double>&t = log_.column("time_ps"), &y = log_.column("potential_kj_mol");
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
  if (automatic_ && log_.has("potential_kj_mol")) all.push_back(equilibration_picture());
  if (frames_) std::ranges::copy(frames_->pictures(curve), std::back_inserter(all));
  if (loads_) std::ranges::copy(loads_->pictures(), std::back_inserter(all));
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
