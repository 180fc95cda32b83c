#include "md/step.hpp"

#include <algorithm>

#include "base/shares.hpp"
#include "md/step_parts.hpp"

namespace taut {
namespace {

// v += k M⁻¹f of atoms first … last − 1. Two at a time: three whole vectors of two numbers.
void kick(const System& sys, double k, int first, int last, State& s) {
  const double *inv_mass = sys.inv_mass.data(), *f = s.f.data();
  double* v = s.v.data();
  int a = first;
  for (; a + 1 < last; a += 2) {
    const double k0 = k * inv_mass[a], k1 = k * inv_mass[a + 1];
    const double of_each[6] = {k0, k0, k0, k1, k1, k1};
    for (int d = 0; d < 6; ++d) v[3 * a + d] += f[3 * a + d] * of_each[d];
  }
  for (; a < last; ++a)
    for (int d = 0; d < 3; ++d) v[3 * a + d] += f[3 * a + d] * (k * inv_mass[a]);
}

}  // namespace

Bath& no_bath() {
  static Bath none;
  return none;
}

void half_kick(const System& sys, double h, const Vectors* jump, State& s) {
  by_atoms(sys.atoms(), [&](int first, int last) {
    if (jump) s.v.middleCols(first, last - first) += jump->middleCols(first, last - first);
    kick(sys, 0.5 * h, first, last, s);
  });
}

void half_kick_and_drift(const System& sys, double h, const Vectors* jump, State& s) {
  constexpr int kBlock = 128;  // atoms that stay in the first cache
  by_atoms(sys.atoms(), [&](int first, int last) {
    for (int a = first; a < last; a += kBlock) {
      const int count = std::min(kBlock, last - a);
      kick(sys, 0.5 * h, a, a + count, s);
      if (jump) s.v.middleCols(a, count) += jump->middleCols(a, count);
      s.x.middleCols(a, count) += h * s.v.middleCols(a, count);
    }
  });
}

SolveStats step(const Dynamics& dynamics, double h, State& s) {
  const System& sys = dynamics.sys;  // clang 14 takes no structured bindings into lambdas
  ConstraintMethod& method = dynamics.method;
  Bath& bath = dynamics.bath;
  const auto hold_bonds = [&](const auto& stage) {
    return in_part(sys.all_bonds() > 0 ? StepPart::kBonds : StepPart::kRest, stage);
  };
  in_part(StepPart::kUpdate, [&] { half_kick_and_drift(sys, h, bath.half_jump(), s); });
  // the old positions are x − hv
  s.t += h;  // forces that depend on time act at the new one
  SolveStats stats = hold_bonds([&] { return method.project_positions(sys, h, s); });  // SHAKE, RATTLE, ...
  bath.move_box(sys, s);
  dynamics.forces.evaluate(sys, s);  // f = F(x)
  Push push = Push::between_steps(h);
  const Bath::Draw drawn = bath.draw(sys, push, s);
  push.noise = drawn.noise;
  stats += drawn.stats;
  stats += hold_bonds([&] { return method.add_forces(sys, push, s); });  // Baumgarte, penalty: f += Jᵀλ
  in_part(StepPart::kUpdate, [&] { half_kick(sys, h, drawn.last_half_jump, s); });
  stats += hold_bonds([&] { return method.project_velocities(sys, h, s); });  // RATTLE
  return stats;
}

}  // namespace taut
