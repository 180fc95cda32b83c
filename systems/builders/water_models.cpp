#include "systems/builders/water_models.hpp"

#include <cmath>
#include <numbers>

namespace taut {

const std::vector<WaterModel>& water_models() {
  static const std::vector<WaterModel> all = {
      // Jorgensen et al. 1983, doi:10.1063/1.445869; numbers of OpenMM's tip3p.xml
      {"tip3p", 0.417, 0.315061, 0.6364, 0.09572, 104.52, 15.99943, 1.007947},
      // Berendsen, Grigera and Straatsma 1987, doi:10.1021/j100308a038
      {"spce", 0.4238, 0.3166, 0.650, 0.1, 109.47, 15.9994, 1.008},
      // Horn et al. 2004, doi:10.1063/1.1683075
      {"tip4pew", 0.52422, 0.316435, 0.680946, 0.09572, 104.52, 15.99943, 1.007947, 1, 0.0125},
      // Abascal and Vega 2005, doi:10.1063/1.2121687; ε/k = 93.2 K
      {"tip4p2005", 0.5564, 0.31589, 0.7749079, 0.09572, 104.52, 15.9994, 1.008, 1, 0.01546},
      // Izadi, Anandakrishnan and Onufriev 2014, doi:10.1021/jz501780a; numbers of OpenMM's opc.xml
      {"opc", 0.679142, 0.3166552081964338, 0.890358601592, 0.087243313, 103.598929736, 15.9994, 1.008, 1,
       0.015939833},
      // Mahoney and Jorgensen 2000, doi:10.1063/1.481505
      {"tip5p", 0.241, 0.312, 0.66944, 0.09572, 104.52, 15.99943, 1.007947, 2, 0.07, 109.47}};
  return all;
}

double WaterModel::half_angle() const {
  return angle * std::numbers::pi / 360;
}

double WaterModel::hh() const {
  return 2 * oh * std::sin(half_angle());
}

void WaterModel::set_geometry(Eigen::Ref<Vectors> x) const {
  const Vec3 o = x.col(0), bisector = (x.col(1) + x.col(2) - 2 * o).normalized();
  Vec3 across = x.col(1) - x.col(2);
  across = (across - bisector.dot(across) * bisector).normalized();
  const double along = oh * std::cos(half_angle()), aside = hh() / 2;
  x.col(1) = o + along * bisector + aside * across;
  x.col(2) = o + along * bisector - aside * across;
}

// r₁₂ + r₁₃ is the bisector, 2 OH cos ½HOH long; r₁₂ × r₁₃ is normal to it, OH² sin HOH long.
VirtualSites WaterModel::sites_of(int o) const {
  const double bisector = 2 * oh * std::cos(half_angle()), normal = oh * oh * std::sin(2 * half_angle());
  if (sites == 0) return {};
  if (sites == 1) {
    const double w = site / bisector;
    return {VirtualSite::average(o + 3, {{o, 1 - 2 * w}, {o + 1, w}, {o + 2, w}})};
  }
  const double half = site_angle * std::numbers::pi / 360;
  const double w = -site * std::cos(half) / bisector, c = site * std::sin(half) / normal;
  return {VirtualSite::out_of_plane(o + 3, o, o + 1, o + 2, {w, w, -c}),
          VirtualSite::out_of_plane(o + 4, o, o + 1, o + 2, {w, w, c})};
}

}  // namespace taut
