#pragma once

#include <vector>

#include "forcefield/terms.hpp"
#include "md/block_average.hpp"
#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

struct Distances {        // g(r)
  std::vector<double> r;  // middle of each bin [nm]
  std::vector<Estimate> g;
};

// What a liquid looks like, gathered frame by frame: the O–O radial distribution of rigid three-site water in
// a box, and the end-to-end distance of unbranched chains of three atoms or more.
class LiquidStructure {
 public:
  LiquidStructure(const System& sys, const Terms& terms, const Box& box);

  bool has_water() const { return oxygens_.size() > 1; }
  bool has_chains() const { return !ends_.empty(); }

  void see(const State& s);

  Distances oxygen_distances() const;
  Estimate end_to_end() const;  // √⟨R²⟩ [nm]

 private:
  static constexpr double kBin = 0.01;  // [nm]

  std::vector<int> oxygens_;
  std::vector<std::array<int, 2>> ends_;
  double reach_ = 0;                         // of g(r): half the box, 1 nm at most [nm]
  std::vector<std::vector<double>> counts_;  // pairs per bin times the volume, a row a frame [nm³]
  std::vector<double> r_squared_;            // mean over the chains, a frame each [nm²]
};

}  // namespace taut
