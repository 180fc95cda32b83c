#pragma once

#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

// The forces between and on atoms, all but those of constraints.
class ForceLaw {
 public:
  virtual ~ForceLaw() = default;
  // Sets s.f = F(s.x), whatever s.f was. Virtual sites in s.x are put in their places first.
  virtual void evaluate(const System& sys, State& s) = 0;
};

}  // namespace taut
