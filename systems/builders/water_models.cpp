#include "systems/builders/water_models.hpp"

#include <algorithm>
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

namespace {

// r₁₂ + r₁₃ is the bisector, 2 OH cos ½HOH long; r₁₂ × r₁₃ is normal to it, OH² sin HOH long.
VirtualSites sites_of(const WaterModel& model) {
  const double bisector = 2 * model.oh * std::cos(model.half_angle());
  const double normal = model.oh * model.oh * std::sin(2 * model.half_angle());
  if (model.sites == 0) return {};
  if (model.sites == 1) {
    const double w = model.site / bisector;
    return {VirtualSite::average(3, {{0, 1 - 2 * w}, {1, w}, {2, w}})};
  }
  const double half = model.site_angle * std::numbers::pi / 360;
  const double w = -model.site * std::cos(half) / bisector, c = model.site * std::sin(half) / normal;
  return {VirtualSite::out_of_plane(3, 0, 1, 2, {w, w, -c}),
          VirtualSite::out_of_plane(4, 0, 1, 2, {w, w, c})};
}

}  // namespace

const WaterModel* water_model(std::string_view name) {
  const auto& all = water_models();
  const auto found = std::ranges::find(all, name, &WaterModel::name);
  return found == all.end() ? nullptr : &*found;
}

Molecule WaterModel::molecule() const {
  Molecule water;
  water.name = name;
  water.kinds = {{"OW", "HOH", "O"}, {"HW1", "HOH", "H"}, {"HW2", "HOH", "H"}};
  if (sites == 1) water.kinds.push_back({"MW", "HOH", ""});
  if (sites == 2) water.kinds.insert(water.kinds.end(), {{"LP1", "HOH", ""}, {"LP2", "HOH", ""}});
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(atoms());
  mass.head<3>() << mass_o, mass_h, mass_h;
  Nonbonded& pairs = water.terms.nonbonded.emplace();
  pairs.charge = Eigen::VectorXd::Constant(atoms(), charge_of_site());
  pairs.charge.head<3>() << charge_o(), charge_h, charge_h;
  pairs.sigma = Eigen::VectorXd::Ones(atoms());  // has no effect, since ε is 0
  pairs.epsilon = Eigen::VectorXd::Zero(atoms());
  pairs.sigma[0] = sigma;
  pairs.epsilon[0] = epsilon;
  for (int a = 0; a < atoms(); ++a)
    for (int b = a + 1; b < atoms(); ++b) pairs.exceptions.push_back({a, b, 0, 1, 0});
  water.system = make_system(std::move(mass), {{0, 1, oh}, {0, 2, oh}, {1, 2, hh()}}, sites_of(*this));
  water.x = Vectors::Zero(3, atoms());
  water.x.col(1) = Vec3(1, 1, 0);
  water.x.col(2) = Vec3(1, -1, 0);
  set_geometry(water.x.leftCols<3>());
  place_sites(water.system.sites, water.x);
  return water;
}

Vectors WaterModel::placed(const Vectors& waters) const {
  const VirtualSites of_one = sites_of(*this);
  Vectors all(3, waters.cols() / 3 * atoms());
  Vectors one = Vectors::Zero(3, atoms());
  for (Eigen::Index m = 0; m < waters.cols() / 3; ++m) {
    one.leftCols<3>() = waters.middleCols<3>(3 * m);
    set_geometry(one.leftCols<3>());
    place_sites(of_one, one);
    all.middleCols(m * atoms(), atoms()) = one;
  }
  return all;
}

}  // namespace taut
