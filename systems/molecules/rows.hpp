#pragma once

#include <Eigen/Core>
#include <array>
#include <list>
#include <string>
#include <vector>

#include "forcefield/terms.hpp"
#include "md/state.hpp"
#include "md/system.hpp"
#include "systems/scene/toml_reader.hpp"

namespace taut {

// Consecutive repeat units of atoms, and rows that are given for one unit and apply to all.
struct Units {
  int each, count = 1;
  bool ring = false;

  int atoms() const { return each * count; }
};

// A row of one unit, or its copy for another one.
struct Row {
  std::size_t line;
  std::array<int, 4> atom;
  const double* number;  // the numbers after the atoms
};

// Reads rows of atoms, counted from 0, and numbers: [i, j, length]. A row of one unit applies to all units. A
// row with an atom counted from the end (-1 is the last of all) applies once.
class RowReader {
 public:
  RowReader(const TomlTable& keys, const Units& units) : keys_(keys), units_(units) {}

  // Reads rows of so many atoms and numbers, and returns them for every unit.
  std::vector<Row> read(const char* key, int atoms, std::size_t numbers, const char* meaning);

  // The same for pairs of atoms; each pair may occur once.
  std::vector<Row> pairs(const char* key, std::size_t numbers, const char* meaning);

  [[noreturn]] void fail(const char* key, const Row& row, const std::string& message) const {
    keys_.fail(key, row.line, message);
  }

 private:
  void check_atoms(const char* key, std::size_t k, const std::vector<double>& atoms) const;

  const TomlTable& keys_;
  const Units units_;
  std::list<Rows> kept_;  // storage that rows point into
};

// Reads bonds, at_least and at_most of atoms with these masses, some of which are virtual sites.
System read_system(RowReader& rows, Eigen::VectorXd mass, VirtualSites sites = {});

void read_springs(RowReader& rows, Terms& terms);
// Reads external forces on atoms: pulls, steered atoms and position restraints.
void read_outer(RowReader& rows, Terms& terms);
// Ties the springs of steered atoms to where these are at the start.
void tie_steered_atoms(const State& start, Terms& terms);

// True while a strut's atoms are not too close and a rope's atoms not too far apart. describe_violation()
// returns what is wrong, or an empty string. Atoms are counted from `first`.
bool is_satisfied(const OneSidedBond& bond, const Vectors& x, Eigen::Index first = 0);
std::string describe_violation(const OneSidedBond& bond, const Vectors& x, Eigen::Index first = 0);

}  // namespace taut
