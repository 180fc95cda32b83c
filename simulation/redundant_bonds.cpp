#include "simulation/redundant_bonds.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/errors.hpp"

namespace taut {

Scene without_redundant_bonds(Scene scene, const Redundancy& redundancy) {
  if (redundancy.none()) return scene;
  if (!redundancy.degenerate.empty() || scene.run.redundant != "drop")
    throw InputError(fmt::format("{}: {}", scene.name, explain(redundancy, scene.system)));
  scene.system = without(scene.system, redundancy.redundant);
  scene.notes.push_back(
      redundancy.redundant.size() == 1
          ? "1 bond is left out that follows from others"
          : fmt::format("{} bonds are left out that follow from others", redundancy.redundant.size()));
  return scene;
}

Scene without_redundant_bonds(Scene scene) {
  const Redundancy redundancy = find_redundancy(scene.system, scene.start.x);
  return without_redundant_bonds(std::move(scene), redundancy);
}

namespace {

// format: of the bond, its atoms, its length as given and as it is.
std::vector<std::string> lengths_off(double by, fmt::format_string<int, int, int, double, double> format,
                                     const System& full, const std::vector<int>& left_out, const Vectors& x) {
  std::vector<std::string> lines;
  for (const int k : left_out) {
    const auto& [i, j, d] = full.bonds[k];
    const double r = full.along(full.bonds[k], x).norm();
    if (std::abs(r - d) > by * d)
      lines.push_back(fmt::format(format, int(k), int(i), int(j), double(d), double(r)));
  }
  return lines;
}

}  // namespace

std::vector<std::string> contradicted_lengths(const System& full, const std::vector<int>& left_out,
                                              const Vectors& x) {
  constexpr double kRounded = 1e-4;  // of a length, as the coordinates of a file leave it
  return lengths_off(kRounded,
                     "bond {} ({}-{}) is left out, with a length of {:.6g} nm; the bonds it follows from "
                     "make it {:.6g} nm",
                     full, left_out, x);
}

std::vector<std::string> lost_lengths(const System& full, const std::vector<int>& left_out,
                                      const Vectors& x) {
  return lengths_off(
      0.01,
      "bond {} ({}-{}), left out as one that follows from others, had {:.6g} nm and has {:.6g} nm: the "
      "others imply it in the plane of the start alone; let no force, velocity or thermostat act across "
      "that plane",
      full, left_out, x);
}

}  // namespace taut
