#pragma once

#include <filesystem>
#include <memory>

#include "forcefield/terms.hpp"
#include "systems/molecules/rows.hpp"
#include "systems/scene/toml_reader.hpp"

namespace taut {

enum class TableOf { kDistance, kAngle };  // in nm, in degrees

// Reads a table of energies: rows of distance or angle, energy [kJ/mol] and, if there is a third column, the force
// −dE/dr [kJ/mol/nm] or −dE/dθ [kJ/mol/degree], at equal spacing, separated by commas or blanks; # begins a comment,
// and a first line of words is the columns' names. The spline goes through the energies. Forces are only held
// against them: by Simpson's rule
//     E_{i+1} − E_{i−1} = −h/3 (F_{i−1} + 4F_i + F_{i+1}),
// which the slopes of a cubic spline obey exactly. Throws InputError, one line with file and line.
std::shared_ptr<const Spline> read_energy_table(const std::filesystem::path& file, TableOf of);

// Reads the file that a key of a section names, and says the key's place in the scene where it is wrong.
std::shared_ptr<const Spline> read_energy_table(const TomlTable& keys, const char* key,
                                                const std::filesystem::path& file, TableOf of);

// Reads `tables` of a molecule: files, and the bonds or angles that have their energies.
void read_tables(const TomlTable& keys, const Units& units, Terms& terms);

}  // namespace taut
