#pragma once

#include <string>
#include <vector>

namespace taut {

struct Summary;

// What a run's own figures say against it, a line each with what to do:
// - bonds further off than the method promises, or by 5 % where it promises nothing;
// - constraints that heat or cool by a quarter of kT or more a nanosecond and degree of freedom and make most
//   of the drift, or an energy that drifts by more than kT, which by itself heats or cools the system by its
//   own temperature or so; either where it is no chance, five standard errors;
// - or else an energy (but for the heat) that ends a tenth of kT a degree of freedom from its start, at more
//   than that pace;
// - a temperature, of the run's later half, a twentieth off the bath's (five standard errors, and only when
// the
//   bath has had twenty times its relaxation time), or without a bath a quarter above the first row's or a
//   third of it. Where forces from outside do work: a hundred times.
// Where a thermostat bears a drift, it counts from where that leaves the temperature off by a hundredth.
std::vector<std::string> doubts(const Summary& summary);

}  // namespace taut
