#pragma once

#include "constraints/baumgarte.hpp"

namespace taut {

// σ̈ = 0 and nothing that brings an error back: Baumgarte without gains. The bonds drift as t², shown.
class None : public Baumgarte {
 public:
  static constexpr const char* kName = "none";
  static constexpr const char* kSummary = "constrained accelerations alone, no correction: shows the drift";

  struct Options {
    void describe(auto&&) {}
  };

  None(const System& sys, const Options&, double h)
      : Baumgarte(sys, {.gains = "numbers", .alpha_per_ps = 0, .beta_per_ps = 0}, h) {}
  std::string setting() const { return "no correction"; }
};

}  // namespace taut
