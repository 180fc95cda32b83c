#include <fmt/format.h>

#include <array>
#include <map>
#include <numbers>
#include <regex>

#include "systems/openmm/custom.hpp"
#include "systems/openmm/formulas.hpp"
#include "systems/openmm/functions.hpp"
#include "systems/openmm/terms.hpp"

namespace taut {
namespace {

using std::numbers::pi;

// Returns an energy of two angles and a torsion of four particles as one of u, w and v.
std::string of_bends_and_turn(std::string energy) {
  constexpr std::array kCalls = {
      std::pair{R"(\bangle\s*\(\s*(p1\s*,\s*p2\s*,\s*p3|p3\s*,\s*p2\s*,\s*p1)\s*\))", "u"},
      std::pair{R"(\bangle\s*\(\s*(p2\s*,\s*p3\s*,\s*p4|p4\s*,\s*p3\s*,\s*p2)\s*\))", "w"},
      std::pair{R"(\bdihedral\s*\(\s*(p1\s*,\s*p2\s*,\s*p3\s*,\s*p4|p4\s*,\s*p3\s*,\s*p2\s*,\s*p1)\s*\))",
                "v"}};
  for (const auto& [call, letter] : kCalls) energy = std::regex_replace(energy, std::regex(call), letter);
  return energy;
}

void read_bending_torsions(const ForceReading& r, const std::string& energy) {
  static const std::vector<KnownEnergy> kKnown = {
      {of_bends_and_turn(kBendingTorsionEnergy), {{"k"}, {"a0"}, {"a1"}, {"a2"}, {"a3"}, {"a4"}}}};
  CustomForce p(r, {"PerBondParameters", {{"u", 0, pi}, {"w", 0, pi}, {"v", -pi, pi}}},
                of_bends_and_turn(energy));
  if (p.recognize(kKnown) < 0)
    r.force.refuse(
        fmt::format("of 4 particles has the energy {}: taut knows {}", energy, kBendingTorsionEnergy));
  r.force.part("Bonds").each("Bond", [&](const Element& term) {
    BendingTorsion t{};
    p.read(term, term_fields(t, r.system.atoms(), {}));
    constexpr std::array kNames = {"a0", "a1", "a2", "a3", "a4"};
    for (std::size_t n = 0; n < kNames.size(); ++n) t.c[n] = p.factor() * p["k"] * p[kNames[n]];
    r.to.terms.bending_torsions.push_back(t);
  });
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
  const Expression::Tables functions = read_functions(r.force, splines);
  if (particles == 4) return read_bending_torsions(r, energy);
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
