#include "measures/bond_loads.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/errors.hpp"
#include "base/even_times.hpp"
#include "base/series.hpp"
#include "base/words.hpp"
#include "measures/figures.hpp"
#include "simulation/run_folder.hpp"

namespace taut {

void BondLoads::add_frame(double t, Eigen::VectorXd tension) {
  if (tension.size() != scene_.system.bond_count())
    throw InputError(fmt::format("a frame at {:g} ps has tensions of {}, the scene {}", t,
                                 counted(tension.size(), "bond"), scene_.system.bond_count()));
  t_.push_back(t);
  frames_.push_back(std::move(tension));
}

std::string BondLoads::atoms_of(int bond) const {
  return fmt::format("{}-{}", scene_.system.bonds[bond].i, scene_.system.bonds[bond].j);
}

std::vector<BondLoads::Load> BondLoads::loads() const {
  const EvenMeans even(t_);
  std::vector<Load> all;
  std::vector<double> y(frames_.size());
  for (int k = 0; k < scene_.system.bond_count(); ++k) {
    for (std::size_t f = 0; f < y.size(); ++f) y[f] = frames_[f][k];
    const auto [least, most] = std::ranges::minmax_element(y);
    const auto at = -*least > *most ? least : most;
    all.push_back({.bond = k,
                   .mean = mean_with_error(even.of(y)),
                   .least = *least,
                   .most = *most,
                   .t = t_[static_cast<std::size_t>(at - y.begin())]});
  }
  return all;
}

std::vector<BondLoads::Load> BondLoads::by_size() const {
  std::vector<Load> all = loads();
  std::ranges::stable_sort(all, std::ranges::greater{}, [](const Load& l) { return std::abs(l.largest()); });
  return all;
}

std::string BondLoads::in_words() const {
  constexpr std::size_t kShown = 20;
  const std::vector<Load> all = by_size();
  std::string text =
      fmt::format("tension of {} in {} [kJ/mol/nm], above 0 where a bond pulls; the largest first\n",
                  counted(std::ssize(all), "bond"), counted(std::ssize(t_), "frame"));
  std::vector<std::vector<std::string>> rows = {{"  bond", "atoms", "mean", "least", "most", "largest at"}};
  for (std::size_t n = 0; n < std::min(kShown, all.size()); ++n)
    rows.push_back({fmt::format("  {}", all[n].bond), atoms_of(all[n].bond), with_error(all[n].mean),
                    fmt::format("{:.5g}", all[n].least), fmt::format("{:.5g}", all[n].most),
                    fmt::format("{:.6g} ps", all[n].t)});
  constexpr int kWide = 120;
  text += table_text(rows, kWide);
  if (all.size() > kShown)
    text += fmt::format("  and {} more: --out or --json has all\n", all.size() - kShown);
  if (!scene_.system.one_sided.empty())
    text += "note: what ropes and struts take over while they act is missing from these tensions\n";
  return text;
}

nlohmann::ordered_json BondLoads::json() const {
  auto json = nlohmann::ordered_json::array();
  for (const Load& load : loads())
    json.push_back({{"bond", load.bond},
                    {"atoms", {scene_.system.bonds[load.bond].i, scene_.system.bonds[load.bond].j}},
                    {"mean_kj_mol_nm", json_of(load.mean)},
                    {"least_kj_mol_nm", load.least},
                    {"most_kj_mol_nm", load.most},
                    {"largest_at_ps", load.t}});
  return json;
}

std::vector<Picture> BondLoads::pictures() const {
  constexpr std::size_t kCurves = 6, kPoints = 500;
  std::string all =
      "bond,atoms,tension_kj_mol_nm,standard_error,least_kj_mol_nm,most_kj_mol_nm,largest_at_ps\n";
  for (const Load& load : loads())
    all += fmt::format("{},{},{:.9g},{:.3g},{:.9g},{:.9g},{:.9g}\n", load.bond, atoms_of(load.bond),
                       load.mean.value, load.mean.error, load.least, load.most, load.t);
  // Where there are more frames than points, of each stretch the largest: a pin has to bear it.
  std::string in_time = "run,t_ps,tension_kj_mol_nm\n";
  const std::vector<Load> sorted = by_size();
  const std::size_t stretch = (t_.size() + kPoints - 1) / kPoints;
  for (std::size_t n = 0; n < std::min(kCurves, sorted.size()); ++n)
    for (std::size_t from = 0; from < t_.size(); from += stretch) {
      std::size_t at = from;
      for (std::size_t f = from; f < std::min(from + stretch, t_.size()); ++f)
        if (std::abs(frames_[f][sorted[n].bond]) > std::abs(frames_[at][sorted[n].bond])) at = f;
      in_time +=
          fmt::format("{},{:.9g},{:.9g}\n", atoms_of(sorted[n].bond), t_[at], frames_[at][sorted[n].bond]);
    }
  return {{"loads", scene_.name + ": tension of each bond; band: from the least to the most", all},
          {"loads_in_time",
           fmt::format("{}: tension of the most loaded bonds{}", scene_.name,
                       stretch > 1 ? fmt::format(", the largest of every {} frames", stretch) : ""),
           in_time}};
}

}  // namespace taut
