#include "systems/openmm/formulas.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

namespace taut {

std::string restraint_energy(const Restraint& like, bool placed) {
  std::vector<std::string> here, place, off, squares;
  for (int c = 0; c < 3; ++c) {
    const bool held = like.axes[c] != 0;
    const std::string x(1, "xyz"[c]), x0 = placed ? x + "0" : "0";
    here.push_back(held ? x : "0");
    place.push_back(held ? x0 : "0");
    if (held) off.push_back(!placed ? x : like.side < 0 ? x0 + "-" + x : x + "-" + x0);
    if (held) squares.push_back(placed ? fmt::format("({}-{})^2", x, x0) : x + "^2");
  }
  if (like.side != 0)
    return fmt::format("0.5*k*max({}{},0)^2", placed || like.side > 0 ? "" : "-", off.front());
  const std::string plain = fmt::format("{}", fmt::join(squares, "+"));
  const std::string images =
      fmt::format("periodicdistance({},{})", fmt::join(here, ","), fmt::join(place, ","));
  if (like.free != 0) return "0.5*k*max(d-free,0)^2;d=" + (like.takes_image ? images : "sqrt(" + plain + ")");
  return like.takes_image ? "0.5*k*" + images + "^2" : "0.5*k*(" + plain + ")";
}

}  // namespace taut
