#include <fmt/format.h>

#include <array>
#include <map>

#include "systems/openmm/custom.hpp"
#include "systems/openmm/formulas.hpp"
#include "systems/openmm/functions.hpp"
#include "systems/openmm/terms.hpp"

namespace taut {
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
  const Expression::Tables functions = read_functions(r.force, splines);
  const auto refuse = [&] {
    r.force.refuse(
        fmt::format("of {} particles has the energy {}: taut knows {} of two and {} of three, of a "
                    "Continuous1DFunction, or a "
                    "multiple of one",
                    particles, energy, kTableOfDistance, kTableOfAngle));
  };
  if (particles != 2 && particles != 3) refuse();
  const auto of_v =
      particles == 2 ? with_variable(energy, "distance", "p", 2) : with_variable(energy, "angle", "p", 3);
  if (!of_v) refuse();
  CustomForce p(r, {"PerBondParameters", {{"v", 0}}}, *of_v, functions);

  std::map<std::vector<double>, std::shared_ptr<const Spline>> known;  // by a term's parameters
  r.force.part("Bonds").each("Bond", [&](const Element& term) {
    std::array<int, 3> atoms{};
    std::vector<Field> fields;
    constexpr std::array kNames = {"p1", "p2", "p3"};
    for (int a = 0; a < particles; ++a) fields.push_back(atom_field(kNames[a], atoms[a], r.system.atoms()));
    p.read(term, fields);
    const auto found = known.try_emplace(p.of_term());
    std::shared_ptr<const Spline>& spline = found.first->second;
    if (found.second) {
      spline = recognize_spline(splines, [&](double v) { return p.energy({{"v", v}}); });
      if (spline && p.branches() && !p.is([&](double v) { return rough_value(*spline, v); }))
        spline = nullptr;
    }
    if (!spline) refuse();
    if (particles == 2)
      r.to.terms.tabulated_bonds.push_back({atoms[0], atoms[1], spline});
    else
      r.to.terms.tabulated_angles.push_back({atoms[0], atoms[1], atoms[2], spline});
  });
}

}  // namespace taut
