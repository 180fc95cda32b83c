#pragma once

namespace taut {

// Of residuals and errors the largest counts. A NaN is larger than any number, and the first one met stays.
constexpr bool worse(double residual, double known) {
  return !(residual <= known) && known == known;
}

}  // namespace taut
