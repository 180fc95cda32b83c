// What holding the bonds costs: ns per bond (per molecule for water) and step, positions and velocities
// together, the first decile over the steps: what one takes when nothing else runs on its core. Real steps on
// states that evolve: free flight, each stage of the step between two readings of the clock (Timed),
// and what the readings themselves take, found with a method that does nothing, taken off.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <vector>

#include "base/threads.hpp"
#include "constraints/projection.hpp"
#include "constraints/registry.hpp"
#include "md/diagnosis.hpp"
#include "molecules.hpp"

namespace taut::bench {
namespace {

struct Case {
  std::string name;
  std::function<Molecules()> make;
  double h;   // [ps]
  int units;  // bonds, or waters
};

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

struct Free : ForceLaw {
  void evaluate(const System&, State& s) override { s.f.setZero(); }
};

// Seconds a step that the stopwatch itself takes.
double stopwatch_cost() {
  static const double cost = [] {
    const System sys = make_system(Eigen::VectorXd::Ones(1), {});
    State s{Vectors::Zero(3, 1), Vectors::Zero(3, 1), Vectors::Zero(3, 1), 0, {}};
    ConstraintMethod nothing;
    Timed timed(nothing);
    Free forces;
    constexpr int kSteps = 100000;
    for (int n = 0; n < kSteps; ++n) demand_converged(sys, s, step({sys, forces, timed}, 1e-3, s), n);
    return timed.seconds() / kSteps;
  }();
  return cost;
}

using Make = decltype(&make_method);

void run(benchmark::State& bench, const Case& c, int threads, std::string_view name, Make make) {
  use_threads(threads);
  const Molecules molecules = c.make();
  const System sys = molecules.system();
  State s = molecules.state();
  const auto owned = make(sys, default_options(name), c.h);
  ConstraintMethod& method = *owned;
  Free forces;
  Projector(sys).positions(sys, s.x);
  initialize({sys, forces, method}, c.h, s);
  for (int n = 0; n < 20; ++n) demand_converged(sys, s, step({sys, forces, method}, c.h, s), n);

  SolveStats stats;
  Timed timed(method);
  std::vector<double> seconds;
  double before = 0;
  for (auto _ : bench) {
    stats += step({sys, forces, timed}, c.h, s);
    if (!stats.converged()) {
      bench.SkipWithError(std::string(in_words(stats.failure)).c_str());
      break;
    }
    seconds.push_back(timed.seconds() - before);
    before = timed.seconds();
    bench.SetIterationTime(std::max(1e-12, seconds.back() - stopwatch_cost()));
  }
  if (seconds.empty()) return;
  const auto decile = seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 10);
  std::nth_element(seconds.begin(), decile, seconds.end());
  bench.counters["ns_per_unit"] = (*decile - stopwatch_cost()) * 1e9 / c.units;
  bench.counters["residual"] = stats.max_residual;
  bench.counters["iterations"] = static_cast<double>(stats.iterations) / static_cast<double>(seconds.size());
}

void add(const Case& c, int threads, std::string_view name, Make make) {
  const char* form = make == make_method ? "fast" : "plain";
  benchmark::RegisterBenchmark(fmt::format("{}/{}/{}/{}", name, c.name, form, threads).c_str(),
                               [=](benchmark::State& bench) { run(bench, c, threads, name, make); })
      ->UseManualTime()
      ->Unit(benchmark::kMicrosecond);
}

void add_methods(const Case& c, bool plain) {
  for (const MethodEntry& method : methods()) {
    if (method.name == "settle" && !c.name.starts_with("water")) continue;
    for (int threads : {1, 2}) add(c, threads, method.name, make_method);
    if (plain && method.make_plain != method.make) add(c, 1, method.name, make_plain);
  }
}

void add_everything() {
  constexpr int kBonds = 80000;
  add_methods({"chains-100x20", [] { return chains(100, 20); }, 0.01, 2000}, true);
  for (int bonds : {10, 20, 50, 1000, 10000})
    add_methods({fmt::format("chains-{}x{}", kBonds / bonds, bonds),
                 [bonds] { return chains(kBonds / bonds, bonds); }, 0.01, kBonds},
                bonds == 1000);
  add_methods({"chains-1x10000", [] { return chains(1, 10000); }, 0.01, 10000}, true);
  add_methods({"chains-1x80000", [] { return chains(1, kBonds); }, 0.01, kBonds}, false);
  add_methods({"rings-1000x20", [] { return rings(1000, 20); }, 0.01, 20000}, false);
  add_methods({"combs-1000x20", [] { return combs(1000, 20); }, 0.01, 20000}, false);
  for (int count : {216, 1000, 10000, 100000})
    add_methods({fmt::format("water-{}", count), [count] { return waters(count); }, 0.001, count},
                count == 1000);
}

}  // namespace
}  // namespace taut::bench

int main(int argc, char** argv) {
  taut::bench::add_everything();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
