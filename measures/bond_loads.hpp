#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "base/statistics.hpp"
#include "measures/picture.hpp"
#include "systems/scene/scene.hpp"

namespace taut {

// What every rigid bond of a run carries: the tensions of its frames, positive where a bond pulls its atoms together.
class BondLoads {
 public:
  explicit BondLoads(const Scene& scene) : scene_(scene) {}  // which must outlive this object

  void add_frame(double t,
                 Eigen::VectorXd tension);  // of each bond; t later than of the one before [ps, kJ/mol/nm]

  std::string in_words() const;  // the bonds with the largest loads, a line each
  nlohmann::ordered_json json() const;
  // Every bond's load, and that of the most loaded bonds in time.
  std::vector<Picture> pictures() const;

 private:
  struct Load {
    int bond;
    Estimate mean;               // [kJ/mol/nm]
    double least = 0, most = 0;  // over the frames
    double t = 0;                // of the largest, whichever its sign [ps]

    double largest() const { return -least > most ? least : most; }
  };
  std::vector<Load> loads() const;  // in the bonds' order
  std::vector<Load> by_size() const;
  std::string atoms_of(int bond) const;  // "0-1"

  const Scene& scene_;
  std::vector<double> t_;
  std::vector<Eigen::VectorXd> frames_;
};

}  // namespace taut
