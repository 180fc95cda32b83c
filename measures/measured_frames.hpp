#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "measures/chain_measures.hpp"
#include "measures/figures.hpp"
#include "measures/liquid_structure.hpp"
#include "measures/picture.hpp"
#include "systems/scene/scene.hpp"

namespace taut {

// The measurements of a trajectory or of a run, frame by frame.
class MeasuredFrames {
 public:
  // atoms: the two names of the radial distribution; empty means the heaviest. The scene must outlive this object.
  // Throws InputError for a name that no atom has.
  MeasuredFrames(const Scene& scene, std::vector<std::string> atoms);

  void add_frame(double t, const Vectors& x, const Box& box);  // [ps], later than the one before

  // The viscosity, by which diffusion in a box is corrected for its size [mPa s], and the temperature [K].
  void set_viscosity(const Estimate& viscosity, double temperature);

  std::string in_words() const;  // lines
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
  std::string spacing() const;  // of the frames: "0.1 ps apart"
  std::string of_pairs() const { return atoms_[0] + "–" + atoms_[1]; }

  const Scene& scene_;
  std::vector<std::string> atoms_;
  double reach_;
  RadialDistribution pairs_;
  EndToEnd chains_;
  ChainMeasures sizes_;
  MeanSquareDisplacement motion_;
  double spacing_ = 0;               // between molecules, (V/N)^⅓; 0 without a box [nm]
  std::vector<double> t_, volumes_;  // of the frames [ps], [nm³]
  Estimate viscosity_;
  double temperature_ = 0;
};

// "; of 400 evenly spaced frames, 0.16 ps apart, from 32 to 96 ps" where a part is not all; else nothing.
std::string said_of(const EvenPart& part, const std::vector<double>& t, const std::string& what);

}  // namespace taut
