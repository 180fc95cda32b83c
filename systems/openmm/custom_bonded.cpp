#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "systems/openmm/custom.hpp"
#include "systems/openmm/formulas.hpp"
#include "systems/openmm/terms.hpp"

namespace taut {
namespace {

using std::numbers::pi;
using Atoms = std::array<int, 4>;

// A known energy, and the function that turns a term of it, at element `at`, into one of taut's terms.
struct Bonded {
  KnownEnergy known;
  void (*add)(OpenMMForce& to, const CustomForce& p, const Atoms& atoms, const Element& at);
};

void add_harmonic_torsion(OpenMMForce& to, const CustomForce& p, const Atoms& a, const Element&) {
  to.terms.harmonic_torsions.push_back({a[0], a[1], a[2], a[3], p["theta0"], p.factor() * p["k"]});
}

// OpenMM's θ is in −π … π, so this is the shorter way round only for θ0 = 0.
void add_unwound_torsion(OpenMMForce& to, const CustomForce& p, const Atoms& a, const Element& at) {
  if (p["theta0"] != 0)
    at.refuse(fmt::format("jumps where theta goes from pi to -pi, as theta0 is {}: write the energy as {}",
                          p["theta0"], kTorsionEnergy));
  add_harmonic_torsion(to, p, a, at);
}

// Returns σ and ε of A/r¹² − C/r⁶ = 4ε((σ/r)¹² − (σ/r)⁶).
void add_pair_of_powers(OpenMMForce& to, const CustomForce& p, const Atoms& a, const Element& at) {
  const double A = p.factor() * p["A"], C = p.factor() * p["C"];
  if (A == 0 && C == 0) return to.pairs.push_back({a[0], a[1], 0, 1, 0});
  if (!(A > 0 && C > 0)) at.refuse(fmt::format("has A = {} and C = {}: taut takes both or none", A, C));
  to.pairs.push_back({a[0], a[1], 0, std::pow(A / C, 1.0 / 6), C * C / (4 * A)});
}

void add_excluded_charges(OpenMMForce& to, const CustomForce& p, const Atoms& a, const Element&) {
  to.excluded_charges.push_back({a[0], a[1], p.factor() * p["q"], p["cut"]});
}

// martini_openmm writes these forces whether or not a molecule has such pairs.
void refuse_cut_pair(OpenMMForce&, const CustomForce&, const Atoms& a, const Element& at) {
  at.refuse(fmt::format("ends the pair {}-{} at a cutoff: taut's exceptions have none", a[0], a[1]));
}

const std::vector<Bonded> kBonds = {
    {{kFeneEnergy, {{"k"}, {"r0"}}},
     [](OpenMMForce& to, const CustomForce& p, const Atoms& a, const Element&) {
       to.terms.fene.push_back({a[0], a[1], p.factor() * p["k"], p["r0"]});
     }},
    {{"0.5*k*(r-r0)^2", {{"k"}, {"r0"}}},
     [](OpenMMForce& to, const CustomForce& p, const Atoms& a, const Element&) {
       to.terms.bonds.push_back({a[0], a[1], p["r0"], p.factor() * p["k"]});
     }},
    {{"4*epsilon*((sigma/r)^12-(sigma/r)^6)", {{"epsilon"}, {"sigma"}}},
     [](OpenMMForce& to, const CustomForce& p, const Atoms& a, const Element&) {
       to.pairs.push_back({a[0], a[1], 0, p["sigma"], p.factor() * p["epsilon"]});
     }},
    {{"A/r^12-C/r^6", {{"A"}, {"C"}}}, add_pair_of_powers},
    {{kExcludedFieldEnergy, {{"q"}, {"cut", 0}}}, add_excluded_charges},
    {{"step(cut-r)*q*(1/r+r^2/(2*cut^3)-3/(2*cut))", {{"q"}, {"cut", 0}}}, refuse_cut_pair},
    {{"step(cut-r)*(A*(1/r^12-1/cut^12)-C*(1/r^6-1/cut^6))", {{"A"}, {"C"}, {"cut", 0}}}, refuse_cut_pair}};
const std::vector<Bonded> kAngles = {
    {{"0.5*k*(theta-theta0)^2", {{"k"}, {"theta0"}}},
     [](OpenMMForce& to, const CustomForce& p, const Atoms& a, const Element&) {
       to.terms.angles.push_back({a[0], a[1], a[2], p["theta0"], p.factor() * p["k"]});
     }},
    {{kCosineAngleEnergy, {{"k"}}},
     [](OpenMMForce& to, const CustomForce& p, const Atoms& a, const Element&) {
       to.terms.cosine_angles.push_back({a[0], a[1], a[2], p.factor() * p["k"]});
     }},
    {{kCosineSquaredEnergy, {{"k"}, {"c0"}}},
     [](OpenMMForce& to, const CustomForce& p, const Atoms& a, const Element&) {
       to.terms.cosine_squared_angles.push_back({a[0], a[1], a[2], p["c0"], p.factor() * p["k"]});
     }},
    {{"0.5*k*(cos(theta)-cos(theta0))^2", {{"k"}, {"theta0"}}},
     [](OpenMMForce& to, const CustomForce& p, const Atoms& a, const Element&) {
       to.terms.cosine_squared_angles.push_back(
           {a[0], a[1], a[2], std::cos(p["theta0"]), p.factor() * p["k"]});
     }},
    {{kRestrictedEnergy, {{"k"}, {"c0"}}},
     [](OpenMMForce& to, const CustomForce& p, const Atoms& a, const Element&) {
       to.terms.restricted_angles.push_back({a[0], a[1], a[2], p["c0"], p.factor() * p["k"]});
     }},
    {{"0.5*k*(cos(theta)-cos(theta0))^2/sin(theta)^2", {{"k"}, {"theta0"}}},
     [](OpenMMForce& to, const CustomForce& p, const Atoms& a, const Element&) {
       to.terms.restricted_angles.push_back({a[0], a[1], a[2], std::cos(p["theta0"]), p.factor() * p["k"]});
     }}};
const std::vector<Bonded> kTorsions = {
    {{kTorsionEnergy, {{"k"}, {"theta0", -pi, pi}}}, add_harmonic_torsion},
    {{"0.5*k*(theta-theta0)^2", {{"k"}, {"theta0", -pi, pi}}}, add_unwound_torsion}};

// OpenMM's names for a custom force between so many atoms, for its parts, and for its coordinate.
struct Shape {
  const char *parameters, *list, *each;
  Quantity coordinate;
  int atoms;
};

void read_custom(const ForceReading& r, const Shape& shape, const std::vector<Bonded>& kinds) {
  std::string energy;
  r.read({{"energy", &energy}, {"usesPeriodic", &r.to.takes_images}});
  r.force.check_parts({shape.parameters, "GlobalParameters", "EnergyParameterDerivatives", shape.list});
  refuse_any(r.force, {"EnergyParameterDerivatives"});
  std::vector<KnownEnergy> known;
  for (const Bonded& kind : kinds) known.push_back(kind.known);
  CustomForce p(r, {shape.parameters, {shape.coordinate}}, energy);
  const int kind = p.recognize(known);
  if (kind < 0) p.refuse_energy(known);
  r.force.part(shape.list).each(shape.each, [&](const Element& term) {
    Atoms atoms{};
    std::vector<Field> fields;
    constexpr std::array kNames = {"p1", "p2", "p3", "p4"};
    for (int a = 0; a < shape.atoms; ++a) fields.push_back(atom_field(kNames[a], atoms[a], r.system.atoms()));
    p.read(term, fields);
    kinds[kind].add(r.to, p, atoms, term);
  });
}

}  // namespace

void read_custom_bonds(const ForceReading& r) {
  read_custom(r, {"PerBondParameters", "Bonds", "Bond", {"r", 0}, 2}, kBonds);
}
void read_custom_angles(const ForceReading& r) {
  read_custom(r, {"PerAngleParameters", "Angles", "Angle", {"theta", 0, pi}, 3}, kAngles);
}
void read_custom_torsions(const ForceReading& r) {
  read_custom(r, {"PerTorsionParameters", "Torsions", "Torsion", {"theta", -pi, pi}, 4}, kTorsions);
}

}  // namespace taut
