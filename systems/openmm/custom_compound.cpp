#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>

#include "systems/openmm/custom.hpp"
#include "systems/openmm/functions.hpp"
#include "systems/openmm/terms.hpp"

namespace taut {
namespace {

// The points p1, p2, p3 of an energy stand for 1, 2, 3, and the functions of points return `coordinate` where they
// are called with the points of a bond, or of an angle in its order; a number that is none otherwise.
Expression::Tables functions_of_points(const double& coordinate) {
  const double none = std::nan("");
  Expression::Tables all;
  all["distance"] = {2, [&coordinate, none](std::span<const double> p) {
                       return p[0] + p[1] == 3 && p[0] != p[1] ? coordinate : none;
                     }};
  all["angle"] = {3, [&coordinate, none](std::span<const double> p) {
                    return p[1] == 2 && p[0] + p[2] == 4 && p[0] != p[2] ? coordinate : none;
                  }};
  return all;
}

}  // namespace

void read_custom_compound(const ForceReading& r) {
  std::string energy;
  int particles = 0;
  r.read({{"energy", &energy},
          {"particles", Field::Integer{&particles, 1, 1000}},
          {"usesPeriodic", &r.to.takes_images}});
  r.force.check_parts(
      {"PerBondParameters", "GlobalParameters", "EnergyParameterDerivatives", "Bonds", "Functions"});
  refuse_any(r.force, {"EnergyParameterDerivatives"});
  Splines splines;
  double coordinate = 0;
  Expression::Tables functions = read_functions(r.force, splines);
  functions.merge(functions_of_points(coordinate));
  CustomForce p(r, {"PerBondParameters", {{"p1"}, {"p2"}, {"p3"}}}, energy, functions);
  const auto refuse = [&] {
    r.force.refuse(
        fmt::format("of {} particles has the energy {}: taut knows {} of two and {} of three, of a "
                    "Continuous1DFunction, or a "
                    "multiple of one",
                    particles, energy, kTableOfDistance, kTableOfAngle));
  };
  if (particles != 2 && particles != 3) refuse();

  std::map<std::vector<double>, std::shared_ptr<const Spline>> known;  // by a term's parameters
  r.force.part("Bonds").each("Bond", [&](const Element& term) {
    std::array<int, 3> atoms{};
    std::vector<Field> fields;
    constexpr std::array kNames = {"p1", "p2", "p3"};
    for (int a = 0; a < particles; ++a) fields.push_back(atom_field(kNames[a], atoms[a], r.system.atoms()));
    p.read(term, fields);
    const auto [at, fresh] = known.try_emplace(p.of_term());
    if (fresh)
      at->second = recognize_spline(splines, [&](double x) {
        coordinate = x;
        return p.energy({{"p1", 1}, {"p2", 2}, {"p3", 3}});
      });
    if (!at->second) refuse();
    if (particles == 2)
      r.to.terms.tabulated_bonds.push_back({atoms[0], atoms[1], at->second});
    else
      r.to.terms.tabulated_angles.push_back({atoms[0], atoms[1], atoms[2], at->second});
  });
}

}  // namespace taut
