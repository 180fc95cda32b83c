#pragma once

#include <array>
#include <cstdint>

#include "forcefield/force_field.hpp"

namespace taut {

// The forces of a run, with what else the last evaluation gave. Barostats take the virial of it.
struct RunForces final : ForceLaw {
  explicit RunForces(ForceField its_field) : field(std::move(its_field)) {}
  void evaluate(const System& sys, State& s) override {
    field.evaluate(sys, s, evaluation);
    if (holds_centre) take_out_net_force(sys, s.f);
  }

  // The atoms that move get no common acceleration: their centre stays, by a force on it that does no work. To take
  // momentum out after it came, step by step, lets the centre slide down its potential and cools what pushes it.
  bool holds_centre = false;
  ForceField field;
  ForceField::Evaluation evaluation;  // of the last call

 private:
  static void take_out_net_force(const System& sys, Vectors& f) {
    Vec3 acceleration = Vec3::Zero();
    for (int a = 0; a < sys.atoms(); ++a)
      if (sys.mass[a] > 0) acceleration += f.col(a);
    acceleration /= sys.mass.sum();
    for (int a = 0; a < sys.atoms(); ++a) f.col(a) -= sys.mass[a] * acceleration;
  }
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
