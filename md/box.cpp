#include "md/box.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace taut {

Eigen::Matrix3d Box::vectors() const {
  Eigen::Matrix3d m;
  for (int d = 0; d < 3; ++d) m.col(d) = lattice_vector(Vec3::Unit(d));
  return m;
}

Box Box::of(const Eigen::Matrix3d& m) {
  return {m.diagonal(), {m(0, 1), m(0, 2), m(1, 2)}};
}

std::string Box::flaw(const Eigen::Matrix3d& m) {
  const Box box = of(m);
  if (!m.allFinite() || !(box.edge.minCoeff() > 0))
    return fmt::format("edges of {} x {} x {} nm, expected more than 0", m(0, 0), m(1, 1), m(2, 2));
  if (m(1, 0) != 0 || m(2, 0) != 0 || m(2, 1) != 0)
    return "vectors not in reduced form, expected a = (ax, 0, 0), b = (bx, by, 0), c = (cx, cy, cz)";
  constexpr double kRounding = 1 + 1e-6;  // as files round halves
  const Vec3 most = kRounding / 2 * Vec3(box.edge[0], box.edge[0], box.edge[1]);
  for (int t = 0; t < 3; ++t)
    if (std::abs(box.tilt[t]) > most[t])
      return fmt::format("{} = {} nm, expected at most half of {} = {} nm: take whole vectors off it",
                         std::array{"bx", "cx", "cy"}[t], box.tilt[t], t < 2 ? "ax" : "by", box.edge[t / 2]);
  return "";
}

}  // namespace taut
