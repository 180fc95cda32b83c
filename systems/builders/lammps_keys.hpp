#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "systems/lammps/units.hpp"
#include "systems/scene/toml_reader.hpp"

namespace taut {

// The keys of [build] that a LAMMPS data file does not say.
struct LammpsKeys {
  std::filesystem::path file;
  LammpsUnits units{};
  std::map<std::string, std::string> style;  // of "Bond Coeffs" and so on, in place of the file's own
  std::vector<double> rigid_bonds, rigid_angles;
  std::vector<double> special_lj = {0, 0, 0}, special_coul = {0, 0, 0};
  bool geometric = true, periodic = true;

  explicit LammpsKeys(const TomlTable& keys);
};

// The key that says a section's style, and the section.
inline constexpr std::pair<const char*, const char*> kLammpsStyles[] = {
    {"atom_style", "Atoms"},
    {"pair_style", "Pair Coeffs"},
    {"bond_style", "Bond Coeffs"},
    {"angle_style", "Angle Coeffs"},
    {"dihedral_style", "Dihedral Coeffs"},
    {"improper_style", "Improper Coeffs"}};

}  // namespace taut
