#pragma once

#include <array>
#include <complex>
#include <string_view>
#include <vector>

namespace taut {

// How an error of one bond evolves from step to step under Baumgarte's law (constraints/README.md derives
// it):
//     σ_{n+1} = trace·σ_n − determinant·σ_{n−1}.
// Since A is solved exactly, the bonds of a cluster obey the same, each by itself, up to terms quadratic in
// σ.

enum class Damping {
  kDiscrete,  // as centred, and σ̈ too is the step's own difference, (σ₊ − 2σ + σ₋)/h²: nothing is fed
  kCentred,   // 2α (J v + ½h² v_ij·a_ij) = 2α (σ₊ − σ₋)/2h, the bond's own rate
  kImplicit,  // 2α J v, v the velocity at the end of the step
  kLagged,    // 2α J v_half, half a step behind
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
  double spectral_radius() const { return std::abs(roots()[0]); }
  // Schur–Cohn: |determinant| < 1 and |trace| < 1 + determinant
  bool stable() const { return std::abs(determinant) < 1 && std::abs(trace) < 1 + determinant; }
  // σ_n from σ_0 and σ_1, in closed form
  double residual(double sigma_0, double sigma_1, int n) const;
};

// The βh from which it is unstable at this αh; 0 where it is at any.
//   discrete, centred, implicit: 2 for αh ≥ 0 (at αh = 0 errors ring for ever);   lagged: 2√(1 − αh) for 0 ≤
//   αh < 1
double stability_limit(double ah, Damping damping);

struct DimensionlessGains {
  double ah, bh;
};

// (αh, βh) with roots r and 0: from its second step on an error shrinks by r a step, σ_{n+1} = r σ_n, which
// is RATTLE's own law where RATTLE reduces errors by r a step. 0 ≤ r < 1; r = 0 is dead-beat.
//   discrete, centred, implicit: αh = 1, (βh)² = 2(1−r);   lagged: αh = ½, (βh)² = 1−r
DimensionlessGains gains_for_decay(double r, Damping damping);

// (αh, βh) with both roots equal to r, 0 ≤ r < 1: an error goes as (a + bn)rⁿ, critically damped.
//   discrete, centred, implicit: αh = (1−r²)/(1+r²), (βh)² = 2(1−r)²/(1+r²);   lagged: αh = (1−r²)/2, βh =
//   1−r
DimensionlessGains gains_for_root(double r, Damping damping);

// (αh, βh) of the recurrence σ₊ = (t + t²)σ − t²σ₋, a pair of roots of modulus t: what RATTLE with a fixed
// number of sweeps does to an error of which they leave the share t (studies/swept_errors.hpp), to the last
// step of it. 0 ≤ t < 1; t = 0 is dead-beat.
//   discrete, centred, implicit: αh = (1−t²)/(1+t²), (βh)² = 2 − 2t(1+t)/(1+t²);   lagged: αh = (1−t²)/2,
//   (βh)² = 1−t
DimensionlessGains gains_for_sweeps(double t, Damping damping);

// What no gain removes: the σ [nm²] at which a bond settles that moves with v = |v_ij| [nm/ps], a = |a_ij|
// [nm/ps²] and v·a = va, taken as slowly varying, λ known:
//   discrete: 0
//   centred:  ¼h⁴a²/(βh)²
//   implicit: (¼h⁴a² + αh·h³ v·a)/(βh)²
//   lagged:   (¼h⁴a² − αh·h² |v − ½ha|²)/(βh)²
struct Motion {
  double v_squared, a_squared, va;
};
double floor_of(double ah, double bh, double h, const Motion& motion, Damping damping);

}  // namespace taut
