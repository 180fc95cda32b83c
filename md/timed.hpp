#pragma once

#include <chrono>

#include "md/step.hpp"

namespace taut {

// A method with a stopwatch around each gap it fills (an unfilled gap costs and counts nothing worth naming).
template <ConstraintMethod M>
class Timed {
 public:
  explicit Timed(M& method) : method_(method) {}

  SolveStats project_positions(const System& sys, double h, State& s) {
    return timed([&] { return method_.project_positions(sys, h, s); });
  }
  SolveStats add_forces(const System& sys, double h, State& s) {
    return timed([&] { return method_.add_forces(sys, h, s); });
  }
  SolveStats project_velocities(const System& sys, double h, State& s) {
    return timed([&] { return method_.project_velocities(sys, h, s); });
  }

  double seconds() const { return std::chrono::duration<double>(spent_).count(); }

 private:
  using Clock = std::chrono::steady_clock;

  SolveStats timed(auto&& gap) {
    const auto start = Clock::now();
    const SolveStats stats = gap();
    spent_ += Clock::now() - start;
    return stats;
  }

  M& method_;
  Clock::duration spent_{};
};

}  // namespace taut
