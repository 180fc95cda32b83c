#include "measures/measured_frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/errors.hpp"
#include "base/nearest_name.hpp"
#include "base/series.hpp"
#include "base/words.hpp"
#include "measures/csv.hpp"
#include "measures/transport.hpp"
#include "simulation/run_folder.hpp"
#include "systems/molecules/whole_molecules.hpp"

namespace taut {
namespace {

std::vector<int> atoms_named(const Scene& scene, const std::string& name) {
  std::vector<int> atoms;
  for (int a = 0; a < scene.system.atoms(); ++a)
    if (scene.names.kinds[static_cast<std::size_t>(scene.names.kind[a])].atom == name) atoms.push_back(a);
  if (!atoms.empty()) return atoms;
  std::vector<std::string_view> names;
  for (const AtomKind& kind : scene.names.kinds) names.emplace_back(kind.atom);
  throw InputError(fmt::format("--atoms: there is no atom \"{}\"{}", name, did_you_mean(name, names)));
}

// Returns the name of the heaviest atom: O in water, the beads of a chain.
std::string heaviest(const Scene& scene) {
  Eigen::Index a = 0;
  scene.system.mass.maxCoeff(&a);
  return scene.names.kinds[static_cast<std::size_t>(scene.names.kind[a])].atom;
}

std::vector<std::string> or_heaviest(std::vector<std::string> atoms, const Scene& scene) {
  if (atoms.empty()) atoms.assign(2, heaviest(scene));
  return atoms;
}

// Three shells of neighbours: as many mean distances between atoms of so many. At most half the box, beyond which images
// would be counted.
double reach_in(const Box& box, std::size_t atoms) {
  constexpr double kShells = 3, kLeast = 1;  // [nm]
  if (!box.periodic() || atoms == 0) return 0;
  const double narrowest = 1 / box.vectors().inverse().rowwise().norm().maxCoeff();
  const double between = std::cbrt(box.volume() / static_cast<double>(atoms));
  return std::min(std::max(kLeast, kShells * between), narrowest / 2);
}

// One of a cube's: its correction is known.
bool is_cubic(const Box& box) {
  constexpr double kAlike = 1e-6;
  return box.periodic() && box.tilt.isZero(kAlike) &&
         box.edge.maxCoeff() - box.edge.minCoeff() <= kAlike * box.edge.x();
}

}  // namespace

std::string said_of(const EvenPart& part, const std::vector<double>& t, const std::string& what) {
  if (part.whole(t) || part.samples.empty()) return "";
  return fmt::format("; of {} evenly spaced {}s, {:.4g} ps apart, from {:.6g} to {:.6g} ps",
                     part.samples.size(), what, part.interval, t[part.samples.front()],
                     t[part.samples.back()]);
}

MeasuredFrames::MeasuredFrames(const Scene& scene, std::vector<std::string> atoms)
    : scene_(scene),
      atoms_(or_heaviest(std::move(atoms), scene)),
      reach_(reach_in(scene.start.box, atoms_named(scene, atoms_[1]).size())),
      pairs_(atoms_named(scene, atoms_[0]), atoms_named(scene, atoms_[1]),
             molecules(scene.system, scene.terms), reach_),
      chains_(chain_ends(scene.system, scene.terms)),
      sizes_(unbranched_chains(scene.system, scene.terms)),
      motion_(scene.system.mass, molecules(scene.system, scene.terms)) {
  const std::vector<int> molecule = molecules(scene.system, scene.terms);
  if (const int count = molecule.empty() ? 0 : *std::ranges::max_element(molecule) + 1;
      count > 1 && scene.start.box.periodic())
    spacing_ = std::cbrt(scene.start.box.volume() / count);
}

void MeasuredFrames::add_frame(double t, const Vectors& x, const Box& box) {
  if (reach_ > 0 && !pairs_.empty()) pairs_.see(t, x, box);
  if (!chains_.empty()) {
    chains_.see(t, x);
    sizes_.add_frame(t, x);
  }
  motion_.see(t, x);
  t_.push_back(t);
  volumes_.push_back(box.periodic() ? box.volume() : 0);
}

std::string MeasuredFrames::spacing() const {
  const auto [low, high] = std::ranges::minmax(spans_of(t_));
  if (t_.size() < 2) return "";
  return even_parts(t_).front().whole(t_) ? fmt::format(", {:.4g} ps apart", high)
                                          : fmt::format(", {:.4g} to {:.4g} ps apart", low, high);
}

void MeasuredFrames::set_viscosity(const Estimate& viscosity, double temperature) {
  viscosity_ = viscosity;
  temperature_ = temperature;
}

MeasuredFrames::Diffusion MeasuredFrames::diffusion(const MeanSquareDisplacement::Result& moved) const {
  constexpr double kStraight = 0.2;
  if (moved.t.empty())
    return {.flaw = fmt::format("{} {} are too few, it takes {}", moved.frames.samples.size(),
                                moved.frames.whole(t_) ? "frames" : "evenly spaced frames", kFramesToFollow)};
  if (std::abs(moved.exponent - 1) > kStraight)
    return {.flaw = fmt::format("the displacement grows as t^{:.2f}, it takes longer until it grows as t",
                                moved.exponent)};
  if (const double far = std::sqrt(moved.squared.back().value); far < spacing_ / 2)
    return {.flaw =
                fmt::format("in {:.4g} ps molecules move {:.2g} nm, less than half of the {:.2g} nm between "
                            "them; it takes a longer run",
                            moved.t.back(), far, spacing_)};
  Diffusion found{.value = moved.diffusion};
  if (viscosity_.value > 0 && is_cubic(scene_.start.box)) {
    const double edge = std::cbrt(correlated_mean(EvenMeans(t_).of(volumes_)).value);
    const double more = finite_size_correction(temperature_, viscosity_.value, edge);
    const double error = more * viscosity_.error / viscosity_.value;
    found.corrected = Estimate{moved.diffusion.value + more,
                               std::sqrt(moved.diffusion.error * moved.diffusion.error + error * error)};
  }
  return found;
}

std::vector<Figure> MeasuredFrames::figures() const {
  std::vector<Figure> all;
  if (!chains_.empty()) {
    all.push_back({"end_to_end_squared_nm2", "⟨R²⟩", "nm²", chains_.squared()});
    all.push_back({"gyration_squared_nm2", "⟨R_g²⟩", "nm²", sizes_.gyration_squared()});
    if (sizes_.pulled())
      all.push_back({"extension_nm", "extension along the pull", "nm", sizes_.extension()});
    if (const auto relaxation = sizes_.relaxation(); relaxation.flaw.empty())
      all.push_back({"relaxation_ps", "relaxation of the ends", "ps", relaxation.time});
  }
  const Diffusion d = diffusion(motion_.result());
  if (d.value) all.push_back({"diffusion_nm2_per_ps", "diffusion", "nm²/ps", *d.value});
  if (d.corrected)
    all.push_back({"diffusion_corrected_nm2_per_ps", "diffusion (box corrected)", "nm²/ps", *d.corrected});
  return all;
}

std::string MeasuredFrames::in_words() const {
  std::string text;
  const auto say = [&]<class... Values>(fmt::format_string<Values...> line, Values&&... values) {
    text += fmt::format(line, std::forward<Values>(values)...);
  };
  const Distances g = pairs_.result();
  const MeanSquareDisplacement::Result moved = motion_.result();
  say("{}: {} of {}{}\n", scene_.name, counted(std::ssize(t_), "frame"),
      counted(scene_.system.atoms(), "atom"), spacing());
  if (!g.r.empty()) {
    const auto peak = std::ranges::max_element(g.g, {}, &Estimate::value) - g.g.begin();
    say("g(r) of {}, in other molecules, up to {:.3g} nm: {} {} at {:.3f} nm\n", of_pairs(), reach_,
        peak + 1 < std::ssize(g.g) ? "highest" : "no peak, it rises to",
        with_error(g.g[static_cast<std::size_t>(peak)]), g.r[static_cast<std::size_t>(peak)]);
  }
  if (!chains_.empty()) {
    say("end to end: ⟨R²⟩ = {} nm², √⟨R²⟩ = {} nm\n", with_error(chains_.squared()),
        with_error(chains_.root()));
    const Estimate gyration = sizes_.gyration_squared();
    say("radius of gyration: ⟨R_g²⟩ = {} nm²; ⟨R²⟩/⟨R_g²⟩ = {:.3f}\n", with_error(gyration),
        chains_.squared().value / gyration.value);
    if (sizes_.pulled())
      say("extension along the pull of {:.4g} kJ/mol/nm: {} nm\n", sizes_.force(),
          with_error(sizes_.extension()));
    if (const auto relaxation = sizes_.relaxation(); relaxation.flaw.empty())
      say("end-to-end vector: ⟨R(0)·R(t)⟩ falls to 1/e within {} ps{}\n", with_error(relaxation.time),
          said_of(relaxation.frames, t_, "frame"));
    else
      say("no relaxation of the end-to-end vector: {}\n", relaxation.flaw);
  }
  if (!moved.t.empty())
    say("molecules' displacement: ⟨Δr²⟩ = {} nm² after {:.4g} ps\n", with_error(moved.squared.back()),
        moved.t.back());
  const Diffusion d = diffusion(moved);
  constexpr double kCm2PerS = 1e-2;  // of nm²/ps
  if (!d.value) return text + fmt::format("no D yet: {}\n", d.flaw);
  say("diffusion: D = {} nm²/ps ({:.3g} cm²/s), the slope from {:.4g} to {:.4g} ps{}\n", with_error(*d.value),
      d.value->value * kCm2PerS, moved.t.back() / 2, moved.t.back(), said_of(moved.frames, t_, "frame"));
  if (d.corrected)
    say("  in an endless liquid of {:.3g} mPa s (Yeh and Hummer): {} nm²/ps\n", viscosity_.value,
        with_error(*d.corrected));
  return text;
}

nlohmann::ordered_json MeasuredFrames::json() const {
  const Distances g = pairs_.result();
  const MeanSquareDisplacement::Result moved = motion_.result();
  nlohmann::ordered_json json = {{"scene", scene_.name},
                                 {"frames", t_.size()},
                                 {"frames_followed", moved.frames.samples.size()},
                                 {"interval_ps", moved.frames.interval}};
  for (const Figure& figure : figures()) json[figure.key] = json_of(figure.value);
  if (!chains_.empty())
    if (const auto relaxation = sizes_.relaxation(); !relaxation.flaw.empty())
      json["relaxation_flaw"] = relaxation.flaw;
  if (const Diffusion d = diffusion(moved); !d.value) json["diffusion_flaw"] = d.flaw;
  if (!moved.t.empty()) json["displacement_exponent"] = moved.exponent;
  for (std::size_t n = 0; n < moved.t.size(); ++n)
    json["displacement"].push_back({moved.t[n], moved.squared[n].value, moved.squared[n].error});
  for (std::size_t n = 0; n < g.r.size(); ++n)
    json["distances"].push_back({g.r[n], g.g[n].value, g.g[n].error});
  return json;
}

std::vector<Picture> MeasuredFrames::pictures(const std::string& curve) const {
  std::vector<Picture> all;
  const std::string run = csv_cell(curve);
  if (const Distances g = pairs_.result(); !g.r.empty()) {
    const std::string of = csv_cell(curve.empty() ? of_pairs() : curve + ": " + of_pairs());
    std::string csv = "run,r_nm,g,standard_error\n";
    for (std::size_t n = 0; n < g.r.size(); ++n)
      csv += fmt::format("{},{:.4f},{:.6f},{:.6f}\n", of, g.r[n], g.g[n].value, g.g[n].error);
    all.push_back(
        {"distances",
         fmt::format("{}: radial distribution of {}, bands: standard errors", scene_.name, of_pairs()), csv});
  }
  if (const auto moved = motion_.result(); !moved.t.empty()) {
    std::string csv = "run,t_ps,squared_nm2,standard_error\n";
    for (std::size_t n = 0; n < moved.t.size(); ++n)
      csv += fmt::format("{},{:.6g},{:.6g},{:.2g}\n", run, moved.t[n], moved.squared[n].value,
                         moved.squared[n].error);
    all.push_back({"displacement",
                   scene_.name + ": mean-square displacement of molecules, bands: standard errors", csv});
  }
  if (chains_.empty()) return all;
  const auto relaxation = sizes_.relaxation();
  std::string csv = "run,t_ps,correlation,standard_error\n";
  for (std::size_t n = 0; n < relaxation.t.size(); ++n)
    csv += fmt::format("{},{:.6g},{:.6g},{:.2g}\n", run, relaxation.t[n], relaxation.correlation[n].value,
                       relaxation.correlation[n].error);
  if (!relaxation.t.empty())
    all.push_back({"relaxation", scene_.name + ": ⟨R(0)·R(t)⟩/⟨R²⟩ of chains, bands: standard errors", csv});
  return all;
}

}  // namespace taut
