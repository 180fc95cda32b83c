#include "constraints/option_checks.hpp"

#include <fmt/format.h>

#include "md/errors.hpp"

namespace taut {

void check_tolerance(double tolerance) {
  if (!(tolerance >= 1e-15 && tolerance <= 0.1))
    throw InputError(fmt::format("method.tolerance: {}, expected between 1e-15 and 0.1", tolerance));
}

void check_count(const char* key, int count, int fewest) {
  if (count < fewest) throw InputError(fmt::format("{}: {}, expected {} or more", key, count, fewest));
}

}  // namespace taut
