#pragma once

namespace taut {

// True if `residual` is larger than `known`. A NaN is larger than any number; a NaN that is known stays.
constexpr bool exceeds(double residual, double known) {
  return !(residual <= known) && known == known;
}

}  // namespace taut
