#pragma once

#include <set>
#include <string>
#include <vector>

#include "constraints/registry.hpp"

namespace taut {

// Which bonds are held: those of a type in `bonds`, or at an atom whose type is in `types` or whose mass is
// one of `masses`; and the third side of angles of a type in `angles` between two held bonds.
struct Selection {
  std::set<int> bonds, angles, types;
  std::vector<double> masses;  // [mass], to within 0.1
};

// What `fix ID group taut METHOD keyword value ...` says. Numbers are in LAMMPS's own units.
struct Keywords {
  MethodOptions method;
  Selection held;
  std::string fixed_group;  // atoms that bonds cannot move: their mass counts as infinite
  int every = 0;            // steps between two lines of statistics; 0: none
  bool clear = false;       // velocities at full steps lose their part along the bonds, as in RATTLE
  bool store = false;       // forces by atom, tensions by bond
  double restraint = -1;    // of the springs during minimize [energy/length²]; less than 0: as fix shake's
  int overlap = 8;          // bonds solved beyond a processor's own, at most
  int exchanges = -1;  // of multipliers with neighbours in a step, besides; less than 0: as many as needed

  double tolerance() const;  // what cuts may leave of bonds, |σ|/d²: the method's, or baumgarte's default
};

// What follows the style's name. Throws InputError.
struct TypeCounts {
  int bonds, angles, atoms;
};
Keywords read_keywords(const std::vector<std::string>& words, const TypeCounts& types);

}  // namespace taut
