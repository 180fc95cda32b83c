#pragma once

#include <string>
#include <vector>

#include "base/even_times.hpp"
#include "base/statistics.hpp"
#include "forcefield/terms.hpp"
#include "md/system.hpp"

namespace taut {

// An unbranched chain of three atoms or more: its atoms, and which of them are its ends.
struct Chain {
  std::vector<int> atoms;
  int first = 0, last = 0;
  Vec3 pull = Vec3::Zero();  // the constant force that pulls the last end away from the first [kJ/mol/nm]
};
std::vector<Chain> unbranched_chains(const System& sys, const Terms& terms);

// What is measured of chains, frame by frame, beside the distance of their ends (measures/measures.hpp):
//     the radius of gyration, R_g² = ⟨|r − r̄|²⟩ over a chain's atoms, each counted once;
//     the extension along the pull, ⟨R·F⟩/|F|, of chains whose ends are pulled;
//     the relaxation of the end-to-end vector, C(t) = ⟨R(0)·R(t)⟩/⟨R²⟩, and the time in which it falls to 1/e.
// Frames are seen with their times, as in measures/measures.hpp. Errors are the larger of what blocks of frames and what groups of chains say.
class ChainMeasures {
 public:
  explicit ChainMeasures(std::vector<Chain> chains);

  bool empty() const { return chains_.empty(); }
  bool pulled() const { return pulled_ > 0; }
  double force() const;                        // the pulled chains' mean force [kJ/mol/nm]
  void add_frame(double t, const Vectors& x);  // [ps]

  Estimate gyration_squared() const;  // [nm²]
  Estimate extension() const;         // [nm]

  struct Relaxation {
    EvenPart frames;                    // of which it is
    std::vector<double> t;              // [ps]
    std::vector<Estimate> correlation;  // C(t)
    Estimate time;                      // [ps]
    std::string flaw;                   // why there is no time; empty if there is one
  };
  Relaxation relaxation() const;

 private:
  // The value of each chain in a frame; chains in columns of `of_chain_`, frames in `of_frame_`.
  struct Series {
    std::vector<double> of_frame, of_chain;
    void add(const std::vector<double>& each);
    Estimate mean(const EvenMeans& even) const;
  };

  std::vector<Chain> chains_;
  long pulled_ = 0;
  std::vector<double> t_;
  Series gyration_, extension_;
  std::vector<Vectors> ends_;  // end-to-end vectors of all chains, a frame each [nm]
};

}  // namespace taut
