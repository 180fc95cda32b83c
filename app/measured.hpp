#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "pictures.hpp"
#include "studies/liquid_structure.hpp"
#include "systems/scene.hpp"

namespace taut {

// The measurements of a trajectory or of a run, frame by frame.
class Measured {
 public:
  // atoms: the two names of the radial distribution; empty means the heaviest. interval: time between frames
  // [ps]. The scene must outlive this object. Throws InputError for a name that no atom has.
  Measured(const Scene& scene, std::vector<std::string> atoms, double interval);

  void add_frame(const Vectors& x, const Box& box);
  long frames() const { return frames_; }

  void print() const;
  nlohmann::ordered_json json() const;
  void draw(StudyFiles& files) const;

 private:
  std::string of_pairs() const { return atoms_[0] + "–" + atoms_[1]; }

  const Scene& scene_;
  std::vector<std::string> atoms_;
  double reach_;
  RadialDistribution pairs_;
  EndToEnd chains_;
  MeanSquareDisplacement motion_;
  long frames_ = 0;
  double interval_;
};

}  // namespace taut
