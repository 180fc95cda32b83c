#include "measured.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/errors.hpp"
#include "base/nearest_name.hpp"
#include "printing.hpp"
#include "systems/whole_molecules.hpp"
#include "words.hpp"

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

// At most half the box, beyond which images would be counted.
double reach_in(const Box& box) {
  return box.periodic() ? std::min(1.0, box.edge.minCoeff() / 2) : 0;
}

std::string with_error(const Estimate& e) {
  return e.error > 0 ? fmt::format("{:.4g} ± {:.1g}", e.value, e.error)
                     : fmt::format("{:.4g} (too few frames for an error)", e.value);
}

}  // namespace

Measured::Measured(const Scene& scene, std::vector<std::string> atoms, double interval)
    : scene_(scene),
      atoms_(or_heaviest(std::move(atoms), scene)),
      reach_(reach_in(scene.start.box)),
      pairs_(atoms_named(scene, atoms_[0]), atoms_named(scene, atoms_[1]),
             molecules(scene.system, scene.terms), reach_),
      chains_(chain_ends(scene.system, scene.terms)),
      motion_(scene.system.mass, molecules(scene.system, scene.terms), interval),
      interval_(interval) {}

void Measured::add_frame(const Vectors& x, const Box& box) {
  if (reach_ > 0 && !pairs_.empty()) pairs_.see(x, box);
  if (!chains_.empty()) chains_.see(x);
  motion_.see(x);
  ++frames_;
}

void Measured::print() const {
  const Distances g = pairs_.result();
  const MeanSquareDisplacement::Result moved = motion_.result();
  say("{}: {} of {}, {:.4g} ps apart\n", scene_.name, counted(frames_, "frame"),
      counted(scene_.system.atoms(), "atom"), interval_);
  if (!g.r.empty()) {
    const auto peak = std::ranges::max_element(g.g, {}, &Estimate::value) - g.g.begin();
    say("g(r) of {}, in other molecules: highest {} at {:.3f} nm\n", of_pairs(),
        with_error(g.g[static_cast<std::size_t>(peak)]), g.r[static_cast<std::size_t>(peak)]);
  }
  if (!chains_.empty())
    say("end to end: ⟨R²⟩ = {} nm², √⟨R²⟩ = {} nm\n", with_error(chains_.squared()),
        with_error(chains_.root()));
  if (moved.t.empty()) return say("mean-square displacement: {} frames are too few, it takes 40\n", frames_);
  say("molecules' displacement: ⟨Δr²⟩ = {} nm² after {:.4g} ps\n", with_error(moved.squared.back()),
      moved.t.back());
  const Estimate& d = moved.diffusion;
  constexpr double kCm2PerS = 1e-2, kStraight = 0.2;  // of nm²/ps
  if (std::abs(moved.exponent - 1) > kStraight)
    return say("no D yet: the displacement grows as t^{:.2f}, it takes longer until it grows as t\n",
               moved.exponent);
  say("diffusion: D = {} nm²/ps ({:.3g} cm²/s), the slope from {:.4g} to {:.4g} ps\n", with_error(d),
      d.value * kCm2PerS, moved.t.back() / 2, moved.t.back());
}

nlohmann::ordered_json Measured::json() const {
  const Distances g = pairs_.result();
  const MeanSquareDisplacement::Result moved = motion_.result();
  nlohmann::ordered_json json = {{"scene", scene_.name}, {"frames", frames_}, {"interval_ps", interval_}};
  const auto estimate = [](const Estimate& e) {
    return nlohmann::ordered_json{{"value", e.value}, {"error", e.error}};
  };
  if (!chains_.empty()) json["end_to_end_squared_nm2"] = estimate(chains_.squared());
  if (!moved.t.empty()) {
    json["diffusion_nm2_per_ps"] = estimate(moved.diffusion);
    json["displacement_exponent"] = moved.exponent;
  }
  for (std::size_t n = 0; n < moved.t.size(); ++n)
    json["displacement"].push_back({moved.t[n], moved.squared[n].value, moved.squared[n].error});
  for (std::size_t n = 0; n < g.r.size(); ++n)
    json["distances"].push_back({g.r[n], g.g[n].value, g.g[n].error});
  return json;
}

void Measured::draw(StudyFiles& files) const {
  if (const Distances g = pairs_.result(); !g.r.empty()) {
    std::string csv = "run,r_nm,g,standard_error\n";
    for (std::size_t n = 0; n < g.r.size(); ++n)
      csv += fmt::format("{},{:.4f},{:.6f},{:.6f}\n", of_pairs(), g.r[n], g.g[n].value, g.g[n].error);
    files.draw({"distances",
                fmt::format("{}: radial distribution of {}, bars: standard errors", scene_.name, of_pairs()),
                csv});
  }
  if (const auto moved = motion_.result(); !moved.t.empty()) {
    std::string csv = "t_ps,squared_nm2,standard_error\n";
    for (std::size_t n = 0; n < moved.t.size(); ++n)
      csv +=
          fmt::format("{:.6g},{:.6g},{:.2g}\n", moved.t[n], moved.squared[n].value, moved.squared[n].error);
    files.draw({"displacement",
                scene_.name + ": mean-square displacement of molecules, bars: standard errors", csv});
  }
}

}  // namespace taut
