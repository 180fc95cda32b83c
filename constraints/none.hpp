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

  static Baumgarte::Options without_gains() {
    return {.gains = "numbers", .alpha_per_ps = 0, .beta_per_ps = 0};
  }

  None(const System& sys, const Options&, double h) : Baumgarte(sys, without_gains(), h) {}
  std::string setting() const { return "no correction"; }
};

}  // namespace taut
