#pragma once

#include <array>
#include <cstdint>

#include "forcefield/force_field.hpp"

namespace taut {

// The forces of a run, with what evaluating them gave besides. Barostats ask it for the virial.
struct RunForces final : ForceLaw {
  explicit RunForces(ForceField its_field) : field(std::move(its_field)) {}
  void evaluate(const System& sys, State& s) override { field.evaluate(sys, s, besides, listen); }

  Listen listen{};  // while a start is made, whose pair lists take long
  ForceField field;
  ForceField::Evaluation besides;  // where the forces were evaluated last
};

// What a barostat is told. What it moves, it moves where a step has drifted and evaluates its forces next:
// they are evaluated no more often, and are always those of the box there is.
struct PressureCoupling {
  double pressure;                       // [kJ/mol/nm³]
  double kT;                             // [kJ/mol]
  long every;                            // steps
  double time_between;                   // of so many steps [ps]
  double relaxation = 1;                 // of c-rescale [ps]
  double compressibility = 0;            // c-rescale's guess of it [nm³·mol/kJ]
  std::array<int, 3> alike = {0, 0, 0};  // edges with the same number change alike
  std::uint64_t seed = 1;
};

}  // namespace taut
