// A simulation computes with its own number of threads, whoever asks it for what.

#include <gtest/gtest.h>

#include <string>
#include <thread>
#include <vector>

#include "base/threads.hpp"
#include "kept_state.hpp"
#include "named_scene.hpp"
#include "simulation/simulation.hpp"

namespace taut::simulation_threads_tests {
namespace {

// Enough atoms for sums that depend on the number of threads, in every part that has such sums.
const std::vector<std::string> kWater = {"build.molecules=1000",     "run.steps=30",
                                         "run.log_every=10",         "forcefield.coulomb=pme",
                                         "forcefield.cutoff_nm=0.9", "run.thermostat=langevin",
                                         "method.name=newton"};

// Bits of all that can be asked of a simulation, and of what becomes of it.
struct Course {
  std::string bits;

  void take(const void* data, std::size_t bytes) { bits.append(static_cast<const char*>(data), bytes); }
  void take(const Eigen::MatrixXd& numbers) { take(numbers.data(), sizeof(double) * numbers.size()); }

  void look_at(Simulation& simulation) {
    const Record r = simulation.record();
    for (const double number : {r.potential, r.kinetic, r.temperature, simulation.constraint_work()})
      take(&number, sizeof number);
    take(*simulation.pressure_tensor());
    take(simulation.bond_tensions());
    take(simulation.velocity());
    take(simulation.thermal_velocity());
    take(simulation.state().x);
    take(simulation.state().f);
    bits += kept(simulation);
  }

  // Everything that computes, each on a thread of its own.
  void follow(Simulation& simulation) {
    const auto on_another_thread = [](const auto& work) { std::thread(work).join(); };
    on_another_thread([&] { look_at(simulation); });
    on_another_thread([&] { simulation.run([](const Record&) {}); });
    look_at(simulation);
    RunSettings more = simulation.scene().run;
    more.steps += 10, more.temperature_k = 280;
    on_another_thread([&] { simulation.change(more); });
    const std::string before = kept(simulation);
    on_another_thread([&] { simulation.run([](const Record&) {}); });
    look_at(simulation);
    on_another_thread([&] { simulation.restore(before); });
    on_another_thread([&] { simulation.run([](const Record&) {}); });
    on_another_thread([&] { EXPECT_FALSE(simulation.diagnose()); });
    const State& now = simulation.state();
    on_another_thread([&] { simulation.set_out_anew(Vectors(now.x), Vectors(0.9 * now.v), {.force = 1e5}); });
    look_at(simulation);
  }
};

TEST(SimulationThreads, AreItsOwnFromItsStartToItsEnd) {
  const Scene water = scene_of("water", kWater);
  Course by_one, by_two, beside_one, beside_two;
  use_threads(1);
  {
    Simulation simulation(water);
    EXPECT_EQ(simulation.threads(), 1);
    by_one.follow(simulation);
  }
  use_threads(2);
  {
    Simulation simulation(water);
    EXPECT_EQ(simulation.threads(), 2);
    by_two.follow(simulation);
  }
  ASSERT_NE(by_one.bits, by_two.bits);

  use_threads(3);
  Simulation one(water, 1), two(water, 2);
  EXPECT_EQ(two.threads(), 2);
  std::thread beside([&] { beside_two.follow(two); });
  beside_one.follow(one);
  beside.join();
  EXPECT_TRUE(beside_one.bits == by_one.bits);
  EXPECT_TRUE(beside_two.bits == by_two.bits);
  EXPECT_EQ(available_threads(), 3);
  use_threads(1);
}

// Sums of one thread and of two round differently, in each part. A single number may round alike by chance: the
// potential is taken at eight displaced copies of the system.
TEST(SimulationThreads, ShowInTheBitsOfEveryPart) {
  const Scene water = scene_of("water", kWater);
  Simulation one(water, 1), two(water, 2);
  const auto potentials = [](Simulation& simulation) {
    std::vector<double> found;
    for (int copy = 0; copy < 8; ++copy) {
      Vectors displaced = simulation.state().x;
      displaced.array() += 0.01;
      simulation.set_out_anew(displaced, Vectors(simulation.state().v));
      found.push_back(simulation.record().potential);
    }
    return found;
  };
  EXPECT_NE(potentials(one), potentials(two));
  EXPECT_NE(*one.pressure_tensor(), *two.pressure_tensor());
  EXPECT_NE(one.bond_tensions(), two.bond_tensions());
}

}  // namespace
}  // namespace taut::simulation_threads_tests
