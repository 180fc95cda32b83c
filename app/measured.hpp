#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "figures.hpp"
#include "pictures.hpp"
#include "studies/chain_measures.hpp"
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

  // The viscosity, by which diffusion in a box is corrected for its size [mPa s], and the temperature [K].
  void set_viscosity(const Estimate& viscosity, double temperature);

  void print() const;
  std::vector<Figure> figures() const;
  nlohmann::ordered_json json() const;
  // Radial distribution, displacement, relaxation of chains: what there is. `curve` names the run in them.
  std::vector<Picture> pictures(const std::string& curve) const;

 private:
  // Diffusion, or why there is none yet.
  struct Diffusion {
    std::optional<Estimate> value{}, corrected{};  // [nm²/ps]
    std::string flaw{};
  };
  Diffusion diffusion(const MeanSquareDisplacement::Result& moved) const;
  std::string of_pairs() const { return atoms_[0] + "–" + atoms_[1]; }

  const Scene& scene_;
  std::vector<std::string> atoms_;
  double reach_;
  RadialDistribution pairs_;
  EndToEnd chains_;
  ChainMeasures sizes_;
  MeanSquareDisplacement motion_;
  double spacing_ = 0;  // between molecules, (V/N)^⅓; 0 without a box [nm]
  double volumes_ = 0;  // sum over the frames [nm³]
  Estimate viscosity_;
  double temperature_ = 0;
  long frames_ = 0;
  double interval_;
};

}  // namespace taut
