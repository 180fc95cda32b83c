#pragma once

#include <array>
#include <string>

#include "base/errors.hpp"
#include "systems/scene/scene.hpp"

namespace taut {

[[noreturn]] inline void refuse_for_lammps(const std::string& what) {
  throw InputError("LAMMPS cannot express it with its usual styles: " + what);
}

// The table between two atoms; null: none.
const Spline* table_between(const Terms& terms, int i, int j);

// The factors of LAMMPS's special_bonds, of pairs one, two and three bonds apart, that give the scene's exceptions. Those
// of virtual sites are left out. Throws InputError for exceptions that are no such factors.
struct SpecialBonds {
  std::array<double, 3> lj = {1, 1, 1}, coulomb = {1, 1, 1};
};
SpecialBonds special_bonds(const Scene& scene);

}  // namespace taut
