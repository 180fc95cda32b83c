#pragma once

#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

class ForceLaw {
 public:
  virtual ~ForceLaw() = default;
  virtual void operator()(const System& sys, State& s) = 0;  // s.f = F(s.x)
  virtual double potential() const { return 0; }             // of the last evaluation [kJ/mol]
};

}  // namespace taut
