#pragma once

#include <vector>

#include "forcefield/terms.hpp"
#include "md/state.hpp"
#include "md/system.hpp"
#include "measures/measures.hpp"

namespace taut {

// Ends of the unbranched chains of three atoms or more.
std::vector<std::array<int, 2>> chain_ends(const System& sys, const Terms& terms);

// What a liquid looks like, gathered frame by frame: the O–O radial distribution of rigid three-site water in
// a box, and the end-to-end distance of chains.
class LiquidStructure {
 public:
  LiquidStructure(const System& sys, const Terms& terms, const Box& box);

  bool has_water() const { return !oxygens_.empty(); }
  bool has_chains() const { return !chains_.empty(); }

  void see(const State& s);

  Distances oxygen_distances() const { return oxygens_.result(); }
  Estimate end_to_end() const { return chains_.root(); }  // √⟨R²⟩ [nm]

 private:
  RadialDistribution oxygens_;
  EndToEnd chains_;
};

}  // namespace taut
