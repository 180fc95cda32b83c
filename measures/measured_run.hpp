#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "measures/bond_loads.hpp"
#include "measures/figures.hpp"
#include "measures/measured_frames.hpp"
#include "measures/run_log.hpp"
#include "measures/transport.hpp"

namespace taut {

// What `taut measure` is asked for.
struct MeasureSettings {
  std::vector<std::string> atoms;   // names of the two atoms of the radial distribution; empty: the heaviest
  std::optional<double> from;       // what is earlier is left out [ps]
  std::optional<double> last;       // so much at the end is measured [ps]
  bool automatic = false;           // from where the run is equilibrated (base/series.hpp)
  std::optional<double> viscosity;  // for the correction of diffusion [mPa s]
  bool tensions = false;            // the load of each bond, which trajectory.h5md has
  long most_frames = 0;             // of the window are read, evenly spaced; 0: all
};

// The log and the trajectory of a run, in one folder or in several that are its segments.
class MeasuredRun {
 public:
  // Throws InputError where there is no run, or nothing of it in the window.
  MeasuredRun(std::vector<std::filesystem::path> segments, const MeasureSettings& settings);

  const Scene& scene() const { return *scene_; }
  std::string name() const { return segments_.front().string(); }
  double from_ps() const { return log_.column("time_ps")[first_row_]; }  // where the measured part begins
  std::vector<Figure> figures() const;
  // The mean tension of the bonds of run.tension_of, and its metric weight, NaN where it has none.
  std::optional<std::array<Figure, 2>> held() const;
  bool metric_weight_varies() const;  // by more than the bonds' lengths are held to
  std::string in_words() const;       // lines
  nlohmann::ordered_json json() const;
  // Equilibration, what the frames show, viscosity: what there is. `curve` names the run in what frames show, where
  // runs are laid over each other.
  std::vector<Picture> pictures(const std::string& curve = "") const;
  // The run's own, as its summary.json has them.
  const std::vector<std::string>& doubts() const { return doubts_; }
  long stride() const { return stride_; }                      // of so many frames one is read
  const std::string& window() const { return window_words_; }  // "4376 rows of the log from 5 to 40 ps"

 private:
  void choose_window(const MeasureSettings& settings);
  void measure_log();
  void measure_frames(const MeasureSettings& settings);
  long stride_for(double begin, long most_frames) const;
  std::vector<double> rows_of(const LogColumn& column) const;  // in the window
  // The same as an even series, without rows that have no value.
  std::vector<double> window_of(const LogColumn& column) const;
  std::vector<double> window_of(std::string_view key) const { return window_of(common_column(key)); }
  Picture equilibration_picture() const;

  std::vector<std::filesystem::path> segments_;
  std::vector<double> shifts_;  // what is added to each segment's times [ps]
  std::unique_ptr<Scene> scene_;
  RunLog log_;
  std::size_t first_row_ = 0;
  bool automatic_ = false;  // found by the rule
  std::string window_words_;
  std::vector<Figure> log_figures_;
  std::optional<GreenKubo> green_kubo_;  // in a box
  std::string viscosity_rows_;           // those it is of, where that is not all
  std::optional<MeasuredFrames> frames_;
  std::optional<BondLoads> loads_;  // where asked for
  std::vector<std::string> doubts_;
  long stride_ = 1;
  std::string no_frames_;  // why there are none
};

}  // namespace taut
