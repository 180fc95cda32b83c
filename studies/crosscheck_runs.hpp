#pragma once

// The runs behind a crosscheck: one start, one schedule of samples, taut and OpenMM alike.

#include <memory>

#include "studies/crosscheck.hpp"
#include "studies/openmm_twin.hpp"

namespace taut {

using Frames = std::vector<Vectors>;  // positions at each sample

// What all runs share.
struct Stage {
  Stage(const Scene& scene, const CrosscheckPlan& plan);

  std::unique_ptr<OpenMMTwin> twin(TwinSettings settings) const;  // at the start
  TwinSettings on_platform(TwinIntegrator integrator = TwinIntegrator::kRattle) const;
  TwinSettings with_plugin(const Contestant& contestant) const;
  bool samples(long step) const;
  bool long_enough() const;                                    // for averages to mean something
  bool uniform(long step) const { return step % every == 0; }  // one of the evenly spaced, for averages

  const CrosscheckPlan& plan;
  Scene
      scene;  // NVE, its start on the bonds; without bonds that follow from others, where that was asked for
  int dof;
  long steps, parting;  // of whole runs, of those that explain
  long every, dense;    // steps between samples: throughout, and until `parting`
  std::vector<bool>
      by_settle;  // of each bond, whether OpenMM holds it by SETTLE, as rigid waters, or else by CCMA
};

// Held against: OpenMM's run and the fine one, frame by frame; null where there is none yet.
struct Against {
  const Frames* openmm = nullptr;
  const Frames* truth = nullptr;
};

struct Followed {
  Track track;
  Frames frames;
};

using EachStep = std::function<void(const State&)>;

// Follows the stage's scene under a contestant's method. `finer` steps are taken for each of the stage's.
Followed follow(const Stage& stage, const Contestant& contestant, long steps, const Against& against,
                int finer = 1, const EachStep& each = {});

// Follows an OpenMM run from where it is. Without numbers, or with bonds that its own integrators lose, it has broken.
Followed follow(const Stage& stage, const std::string& name, OpenMMTwin& twin, long steps,
                const Against& against);

// Newton's method with a tolerance that rounding allows.
Contestant exact(const std::string& name);

// Takes an OpenMM run's steps, a few at a time where anything listens.
void advance(OpenMMTwin& twin, long steps);

double most_apart(const Vectors& x, const Vectors& y);  // largest distance of an atom from its twin [nm]

// Runs what nothing else depends on. Returns the first line of why it broke; empty: it did not.
std::string run_or_say_why(const std::function<void()>& run);

// Measures whole steps per second of taut and of OpenMM on equal threads, of those that last so long.
std::vector<Speed> measure_speed(const Stage& stage);

}  // namespace taut
