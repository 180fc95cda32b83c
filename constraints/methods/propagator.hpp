#pragma once

#include <array>
#include <complex>
#include <string_view>
#include <vector>

namespace taut {

// The recurrence of the error of one bond under Baumgarte's law (derived in constraints/README.md):
//     σ_{n+1} = trace·σ_n − determinant·σ_{n−1}.
// Because A λ = b is solved exactly, each bond of a cluster obeys it by itself, up to terms quadratic in σ.

enum class Damping {
  kDiscrete,  // as centred, and σ̈ is a difference, too: (σ₊ − 2σ + σ₋)/h²
  kCentred,   // 2α (J v + ½h² v_ij·a_ij) = 2α (σ₊ − σ₋)/2h
  kImplicit,  // 2α J v, v the velocity at the end of the step
  kLagged,    // 2α J v_half, which is half a step old
};
inline constexpr Damping kDampings[] = {Damping::kDiscrete, Damping::kCentred, Damping::kImplicit,
                                        Damping::kLagged};
std::string_view name_of(Damping damping);
std::vector<std::string_view> damping_names();
Damping damping_named(std::string_view name);  // throws InputError

struct Propagator {
  double trace, determinant;

  // ah = αh, bh = βh
  //   discrete, centred, implicit: trace (2 − (βh)²)/(1 + αh),  determinant (1 − αh)/(1 + αh)
  //   lagged:            trace 2 − 2αh − (βh)²,       determinant 1 − 2αh
  Propagator(double ah, double bh, Damping damping);

  std::array<std::complex<double>, 2> roots() const;  // of z² − trace z + determinant, larger modulus first
  // Schur–Cohn: |determinant| < 1 and |trace| < 1 + determinant
  bool stable() const { return std::abs(determinant) < 1 && std::abs(trace) < 1 + determinant; }
  // σ_n from σ_0 and σ_1, in closed form
  double residual(double sigma_0, double sigma_1, int n) const;
};

// Returns the smallest βh that is unstable at this αh; 0 if every βh is.
//   discrete, centred, implicit: 2 for αh ≥ 0 (at αh = 0 errors oscillate without decay)
//   lagged:                      2√(1 − αh) for 0 ≤ αh < 1
double stability_limit(double ah, Damping damping);

struct DimensionlessGains {
  double ah, bh;
};

// Returns (αh, βh) with the roots r and 0, 0 ≤ r < 1: from the second step on, σ_{n+1} = r σ_n, as with a
// RATTLE that reduces errors by r per step. r = 0 is dead-beat.
//   discrete, centred, implicit: αh = 1, (βh)² = 2(1−r)
//   lagged:                      αh = ½, (βh)² = 1−r
DimensionlessGains gains_for_decay(double r, Damping damping);

// Returns (αh, βh) with both roots equal to r, 0 ≤ r < 1 (critical damping): an error evolves as (a + bn)rⁿ.
//   discrete, centred, implicit: αh = (1−r²)/(1+r²), (βh)² = 2(1−r)²/(1+r²)
//   lagged:                      αh = (1−r²)/2,      βh = 1−r
DimensionlessGains gains_for_root(double r, Damping damping);

// Returns (αh, βh) of the recurrence σ₊ = (t + t²)σ − t²σ₋, a pair of roots of modulus t, 0 ≤ t < 1. So
// evolves an error under RATTLE with a fixed number of sweeps that leave the fraction t of it
// (studies/swept_errors.hpp). t = 0 is dead-beat.
//   discrete, centred, implicit: αh = (1−t²)/(1+t²), (βh)² = 2 − 2t(1+t)/(1+t²)
//   lagged:                      αh = (1−t²)/2,      (βh)² = 1−t
DimensionlessGains gains_for_sweeps(double t, Damping damping);

// The floor: the σ [nm²] at which a bond settles whatever its gains, if it moves with v = |v_ij| [nm/ps], a =
// |a_ij| [nm/ps²] and v·a = va, which vary slowly, and λ* has no error:
//   discrete: 0
//   centred:  ¼h⁴a²/(βh)²
//   implicit: (¼h⁴a² + αh·h³ v·a)/(βh)²
//   lagged:   (¼h⁴a² − αh·h² |v − ½ha|²)/(βh)²
struct Motion {
  double v_squared, a_squared, va;
};
double floor_of(double ah, double bh, double h, const Motion& motion, Damping damping);

}  // namespace taut
