#pragma once

#include <chrono>

#include "md/constraint_method.hpp"

namespace taut {

// Measures the time that a method takes in its stages.
class Timed : public ConstraintMethod {
 public:
  explicit Timed(ConstraintMethod& method) : method_(method) {}

  SolveStats project_positions(const System& sys, double h, State& s) override {
    return timed([&] { return method_.project_positions(sys, h, s); });
  }
  SolveStats add_forces(const System& sys, const Push& push, State& s) override {
    return timed([&] { return method_.add_forces(sys, push, s); });
  }
  SolveStats project_velocities(const System& sys, double h, State& s) override {
    return timed([&] { return method_.project_velocities(sys, h, s); });
  }

  double seconds() const { return std::chrono::duration<double>(spent_).count(); }

 private:
  using Clock = std::chrono::steady_clock;

  SolveStats timed(const auto& stage) {
    const auto start = Clock::now();
    const SolveStats stats = stage();
    spent_ += Clock::now() - start;
    return stats;
  }

  ConstraintMethod& method_;
  Clock::duration spent_{};
};

}  // namespace taut
