#pragma once

#include <algorithm>
#include <concepts>

#include "md/state.hpp"
#include "md/system.hpp"
#include "md/threads.hpp"
#include "md/worse.hpp"

namespace taut {

// What a method did in one step. Not to be dropped: who does not look at it goes on with broken bonds.
struct [[nodiscard]] SolveStats {
  int iterations = 0;             // sweeps or linear solves
  double max_residual = 0;        // largest |σ|/d² it saw and left
  int worst_bond = -1;            // where; of a failure: the bond to blame
  const char* failure = nullptr;  // why it gave up; null: it converged

  bool converged() const { return failure == nullptr; }

  // One stage after another: iterations add up.
  SolveStats& operator+=(const SolveStats& next) {
    iterations += next.iterations;
    return keep_worst(next);
  }
  // Clusters or threads side by side: the most iterations.
  SolveStats& beside(const SolveStats& other) {
    iterations = std::max(iterations, other.iterations);
    return keep_worst(other);
  }

 private:
  // The first failure with the bond and the residual that are its own; where all converged the worst
  // residual.
  SolveStats& keep_worst(const SolveStats& other) {
    const bool replaced = converged() && (!other.converged() || worse(other.max_residual, max_residual));
    if (!replaced) return *this;
    max_residual = other.max_residual;
    worst_bond = other.worst_bond;
    failure = other.failure;
    return *this;
  }
};

// A force field writes s.f = F(s.x).
template <class F>
concept ForceLaw = requires(F& forces, const System& sys, State& s) {
  forces(sys, s);
};

// A constraint method fills up to three gaps of the step (constraints/gaps.hpp has the empty ones).
template <class M>
concept ConstraintMethod = requires(M& method, const System& sys, double h, State& s) {
  { method.project_positions(sys, h, s) } -> std::same_as<SolveStats>;
  { method.add_forces(sys, h, s) } -> std::same_as<SolveStats>;
  { method.project_velocities(sys, h, s) } -> std::same_as<SolveStats>;
};

// work(first, count) of all atoms, by threads.
template <class Work>
void by_atoms(int atoms, const Work& work) {
  constexpr int kAtomsOfThread = 2000;  // fewer are not worth waking a thread for
  const int threads = std::clamp(atoms / kAtomsOfThread, 1, available_threads());
  in_parallel(threads, [&](int t) {
    const Share share(atoms, t, threads);
    work(share.begin, share.end - share.begin);
  });
}

// v += (h/2) M⁻¹f
inline void half_kick(const System& sys, double h, State& s) {
  by_atoms(sys.atoms(), [&](int first, int count) {
    s.v.middleCols(first, count).array() +=
        s.f.middleCols(first, count).array().rowwise() *
        (0.5 * h * sys.inv_mass.segment(first, count).transpose().array());
  });
}

// x += hv
inline void drift(double h, State& s) {
  by_atoms(static_cast<int>(s.x.cols()),
           [&](int first, int count) { s.x.middleCols(first, count) += h * s.v.middleCols(first, count); });
}

// A thermostat that changes the velocity by Δ in the middle of the drift (constraints/langevin.hpp) has
//     first_half(s)        v += ½Δ
//     draw(sys, h, s)      the next Δ; f is told of it, for those who steer by forces
//     second_half(s)       f forgets it; v += ½ of the Δ before
// This one does nothing.
struct NoBath {
  void first_half(State&) const {}
  SolveStats draw(const System&, double, State&) const { return {}; }
  void second_half(State&) const {}
};

// One step of velocity Verlet, length h [ps].
template <ForceLaw F, ConstraintMethod M, class Bath = NoBath>
SolveStats step(const System& sys, F& forces, M& method, double h, State& s, Bath&& bath = Bath{}) {
  half_kick(sys, h, s);
  bath.first_half(s);
  drift(h, s);                                             // the old positions are x − hv
  SolveStats stats = method.project_positions(sys, h, s);  // SHAKE, RATTLE, ...
  forces(sys, s);                                          // f = F(x)
  stats += bath.draw(sys, h, s);
  stats += method.add_forces(sys, h, s);  // Baumgarte, penalty: f += Jᵀλ
  bath.second_half(s);
  half_kick(sys, h, s);
  stats += method.project_velocities(sys, h, s);  // RATTLE
  s.t += h;
  return stats;
}

}  // namespace taut
