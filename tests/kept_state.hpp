#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "simulation/simulation.hpp"

namespace taut {

// All that a checkpoint keeps of a simulation, as bytes.
inline std::string kept(Simulation& simulation) {
  std::string bytes;
  Archive archive = Archive::saving_to(bytes);
  simulation.serialize(archive);
  return bytes;
}

// How a run ended: the last row of its log, and its results.
struct Ending {
  Record row;
  Summary summary;
};

// Runs a scene to its end, and another simulation from what was kept at a step. Expects the same positions and velocities
// to the last bit, and returns both endings.
inline std::pair<Ending, Ending> expect_to_go_on_from(const Scene& scene, long step) {
  Simulation whole(scene), first(scene), second(scene);
  const auto end_of = [](Simulation& simulation) {
    Record last;
    const Summary summary = simulation.run([&](const Record& r) { last = r; });
    return Ending{last, summary};
  };
  const Ending end_of_whole = end_of(whole);
  std::string bytes;
  first.run({}, [&](long now) {
    if (now == step) bytes = kept(first);
  });
  second.restore(bytes);
  const Ending end_of_second = end_of(second);
  EXPECT_EQ(whole.state().x, second.state().x);
  EXPECT_EQ(whole.state().v, second.state().v);
  return {end_of_whole, end_of_second};
}

}  // namespace taut
