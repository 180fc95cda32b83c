#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <string_view>
#include <vector>

namespace taut {

// The recurrence of the error of one bond under Baumgarte's law (derived in constraints/README.md):
//     σ_{n+1} = trace·σ_n − determinant·σ_{n−1}.
// Because σ₊ = τ is solved for all bonds at once, each obeys it by itself, but for what the solve leaves.

// The forms of the law. Solved without remainder, each is σ₊ = trace·σ − determinant·σ₋ and, but for the first, a
// drive (below), since its σ̈ or σ̇ is not the difference that the step makes of it.
enum class Damping {
  kDiscrete,  // (σ₊ − 2σ + σ₋)/h² + 2α (σ₊ − σ₋)/2h + β²σ = 0: what taut's method solves
  kCentred,  // σ̈ = J a + |v_ij|² of the textbooks, with 2α (σ₊ − σ₋)/2h = 2α (J v + ½h² v_ij·a_ij)
  kImplicit,  // that σ̈, and 2α J v, v the velocity at the end of the step
  kLagged,    // that σ̈, and 2α J v_half, which is half a step old
};
inline constexpr Damping kDampings[] = {Damping::kDiscrete, Damping::kCentred, Damping::kImplicit,
                                        Damping::kLagged};
std::string_view name_of(Damping damping);
std::vector<std::string_view> damping_names();
Damping damping_named(std::string_view name);  // throws InputError

struct Propagator {
  double trace, determinant;
  double from_rest;  // σ₁/σ₀ = 1 − ½(βh)² where nothing moves before: forces then act for half a step

  // ah = αh, bh = βh
  //   discrete, centred, implicit: trace (2 − (βh)²)/(1 + αh),  determinant (1 − αh)/(1 + αh)
  //   lagged:            trace 2 − 2αh − (βh)²,       determinant 1 − 2αh
  Propagator(double ah, double bh, Damping damping);

  std::array<std::complex<double>, 2> roots() const;  // of z² − trace z + determinant, larger modulus first
  // Schur–Cohn: |determinant| < 1 and |trace| < 1 + determinant
  bool stable() const { return std::abs(determinant) < 1 && std::abs(trace) < 1 + determinant; }
  double next(double sigma, double sigma_before) const { return trace * sigma - determinant * sigma_before; }
  // Σ|σ_n| of an error 1 that comes from nowhere: the most that may stand where 1 is fed in every step.
  double most_of_a_feed() const;
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

// What a form of the law adds to σ₊: square_a |a|² + cross v·a + square_v |v|², with the acceleration a of a bond and its
// velocity v half a step ago. It follows from (1) and (2) in README.md:
//     discrete  0
//     centred   ¼h⁴|a|²/(1 + αh)
//     implicit  (¼h⁴|a|² + αh·h³ (v + ½ha)·a)/(1 + αh)
//     lagged    ¼h⁴|a|² − αh·h²|v|²
// In the first step each adds ½h³ v·a + ⅛h⁴|a|², v being of the full step.
struct Drive {
  double square_a = 0, cross = 0, square_v = 0;

  bool none() const { return square_a == 0 && cross == 0 && square_v == 0; }
  double operator()(const Eigen::Vector3d& v, const Eigen::Vector3d& a) const {
    return square_a * a.squaredNorm() + cross * v.dot(a) + square_v * v.squaredNorm();
  }
};
Drive drive_of(double ah, double h, Damping damping);

// A form of the law with gains.
struct Law {
  Propagator decay;
  Drive drive;

  Law(double ah, double bh, double h, Damping damping)
      : decay(ah, bh, damping), drive(drive_of(ah, h, damping)) {}
  // The floor: the σ [nm²] at which a bond settles whatever its gains, if it moves with v [nm/ps], of half a step ago, and
  // a [nm/ps²] that vary slowly.
  double floor(const Eigen::Vector3d& v, const Eigen::Vector3d& a) const {
    return drive(v, a) / (1 - decay.trace + decay.determinant);
  }
};

}  // namespace taut
