#pragma once

#include <string>
#include <vector>

namespace taut {

struct Summary;

// What a run's own figures say against it, a line each with what to do: bonds further off than the method
// promises (or by 5 %, where it promises nothing), constraints that heat or cool by a quarter of kT or more
// and make most of the drift, and an energy that drifts by more than kT per degree of freedom in a
// nanosecond, which by itself heats or cools the system by its own temperature or so, where that is no
// chance: five standard errors. Where a thermostat bears it, a drift counts from where it leaves the
// temperature off by a hundredth.
std::vector<std::string> doubts(const Summary& summary);

}  // namespace taut
