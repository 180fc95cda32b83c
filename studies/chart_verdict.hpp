#pragma once

#include <optional>
#include <string>
#include <vector>

#include "studies/repeats.hpp"

namespace taut {

// A setting of a chart that got through.
struct ChartPoint {
  std::string method, name;  // "feedforward", "feedforward (order 2)"
  double error = 0;          // of the bonds, rms, relative
  Quartiles cost;            // [ns a bond and step]
  std::optional<bool>
      keeps_energy;  // the drift's 95 % interval holds zero; none: it has no interval, or it failed
  double width = 0;  // half that interval [kJ/mol/ns/degree of freedom]
};

// What a chart says in words, a line each: which setting to take at this step [fs], the cheapest that keeps the energy
// with a good bond error; the cheapest below three errors of the bonds; and those that keep the energy. Of settings whose
// quartiles overlap with the cheapest one's, those of other methods are named too.
std::vector<std::string> chart_verdict(std::vector<ChartPoint> points, double dt_fs);

// Says that times are noise where the machine's load of the last minute leaves less than half a core free; else "".
std::string warn_of_load(double load, long cores);

}  // namespace taut
