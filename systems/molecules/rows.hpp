#pragma once

#include <Eigen/Core>
#include <array>
#include <list>
#include <string>
#include <vector>

#include "forcefield/terms.hpp"
#include "md/system.hpp"
#include "systems/toml_reader.hpp"

namespace taut {

// Units of atoms behind one another, and rows that are said of one and count in all.
struct Units {
  int each, count = 1;
  bool ring = false;

  int atoms() const { return each * count; }
};

// A row of one unit, or its copy in another.
struct Row {
  std::size_t line;
  std::array<int, 4> atom;
  const double* number;  // those behind the atoms
};

// Reads what is said in rows of atoms, counted from 0, and numbers: [i, j, length]. A row of one unit counts
// in all. One with an atom that is counted from the end (-1 is the last of all) counts once.
class RowReader {
 public:
  RowReader(const TomlTable& keys, const Units& units) : keys_(keys), units_(units) {}

  // Rows of so many atoms and numbers, for every unit.
  std::vector<Row> read(const char* key, int atoms, std::size_t numbers, const char* meaning);

  // The same of two atoms, each pair once.
  std::vector<Row> pairs(const char* key, std::size_t numbers, const char* meaning);

  [[noreturn]] void fail(const char* key, const Row& row, const std::string& message) const {
    keys_.fail(key, row.line, message);
  }

 private:
  void check_atoms(const char* key, std::size_t k, const std::vector<double>& atoms) const;

  const TomlTable& keys_;
  const Units units_;
  std::list<Rows> kept_;  // what rows point into
};

// bonds, at_least and at_most of atoms of these masses.
System read_system(RowReader& rows, Eigen::VectorXd mass);

void read_springs(RowReader& rows, Terms& terms);
// What acts on atoms from outside: pulls, and restraints to a place.
void read_outer(RowReader& rows, Terms& terms);

// A strut's atoms, those `first` further on, are not too close, a rope's not too far apart; what is wrong
// where they are, else nothing.
bool within_reach(const OneSidedBond& bond, const Vectors& x, Eigen::Index first = 0);
std::string beyond(const OneSidedBond& bond, const Vectors& x, Eigen::Index first = 0);

}  // namespace taut
