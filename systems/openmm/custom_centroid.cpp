// Biases: CustomCentroidBondForce, and CustomCVForce of one variable. Their energies are recognized as laws of it.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "systems/openmm/biases.hpp"
#include "systems/openmm/custom.hpp"
#include "systems/openmm/terms.hpp"

namespace taut {
namespace {

using Variable = Bias::Variable;
constexpr double kOpen = std::numeric_limits<double>::infinity();
constexpr const char* kBiasRemedy =
    "; take the force out, and give taut a bias of its own: biases=[taut.Distance(...)] in Python, [[bias]] "
    "elsewhere";
// As the writer has them, of the variable v.
constexpr const char* kWritten = "0.5*k*(step(v-b)*(v-b)^2+step(a-v)*(a-v)^2)-F*v";
constexpr const char* kWrittenOfTorsions =
    "0.5*k*(step(w-b)*(w-b)^2+step(a-w)*(a-w)^2)-F*w; w=v-turn*floor((v-(a+b)/2)/turn+0.5); "
    "turn=6.283185307179586";

// A law of the variable v, and how a bias has its numbers.
struct BiasLaw {
  KnownEnergy known;
  void (*set)(Bias& bias, const CustomForce& p);
};

void hold(Bias& bias, double k, double lower, double upper) {
  bias.k = k;
  bias.lower = lower > -kFarWall ? lower : -kOpen;
  bias.upper = upper < kFarWall ? upper : kOpen;
}

void set_all(Bias& bias, const CustomForce& p) {
  hold(bias, p.factor() * p["k"], p["a"], p["b"]);
  bias.force = p.factor() * p["F"];
}

const std::vector<BiasLaw> kBiasLaws = {
    {{"0.5*k*(v-at)^2", {{"k"}, {"at"}}},
     [](Bias& b, const CustomForce& p) { hold(b, p.factor() * p["k"], p["at"], p["at"]); }},
    {{"(v-at)^2", {{"at"}}},
     [](Bias& b, const CustomForce& p) { hold(b, 2 * p.factor(), p["at"], p["at"]); }},
    {{"0.5*k*max(v-b,0)^2", {{"k"}, {"b"}}},
     [](Bias& b, const CustomForce& p) { hold(b, p.factor() * p["k"], -kOpen, p["b"]); }},
    {{"0.5*k*max(a-v,0)^2", {{"k"}, {"a"}}},
     [](Bias& b, const CustomForce& p) { hold(b, p.factor() * p["k"], p["a"], kOpen); }},
    {{"0.5*k*(max(v-b,0)^2+max(a-v,0)^2)", {{"k"}, {"a"}, {"b"}}, "b-a"},
     [](Bias& b, const CustomForce& p) { hold(b, p.factor() * p["k"], p["a"], p["b"]); }},
    {{"0.5*k*max(abs(v-at)-wide,0)^2", {{"k"}, {"at"}, {"wide"}}, "wide"},
     [](Bias& b, const CustomForce& p) {
       hold(b, p.factor() * p["k"], p["at"] - p["wide"], p["at"] + p["wide"]);
     }},
    {{"-F*v", {{"F"}}}, [](Bias& b, const CustomForce& p) { b.force = p.factor() * p["F"]; }},
    {{"-v", {}}, [](Bias& b, const CustomForce& p) { b.force = p.factor(); }},
    {{kWritten, {{"k"}, {"a"}, {"b"}, {"F"}}}, set_all}};

const std::vector<BiasLaw> kLawsOfTorsions = {
    {{"0.5*k*min(turn,2*pi-turn)^2;turn=abs(v-at);pi=3.141592653589793",
      {{"k"}, {"at", -2 * std::numbers::pi, 2 * std::numbers::pi}}},
     [](Bias& b, const CustomForce& p) { hold(b, p.factor() * p["k"], p["at"], p["at"]); }},
    {{"-v", {}},
     [](Bias& b, const CustomForce& p) { b.force = p.factor(); }},  // of a variable within a CustomCVForce
    {{kWrittenOfTorsions, {{"k"}, {"a"}, {"b"}, {"F"}}}, set_all}};

Quantity range_of(Variable variable) {
  if (variable == Variable::kTorsion) return {"v", -std::numbers::pi, std::numbers::pi};
  if (variable == Variable::kAngle) return {"v", 0, std::numbers::pi};
  return {"v", 0};
}

// Returns the law that an energy is, or null.
const BiasLaw* find_law(CustomForce& p, Variable variable) {
  const std::vector<BiasLaw>& laws = variable == Variable::kTorsion ? kLawsOfTorsions : kBiasLaws;
  std::vector<KnownEnergy> known;
  for (const BiasLaw& law : laws) known.push_back(law.known);
  const int found = p.recognize(known);
  return found < 0 ? nullptr : &laws[static_cast<std::size_t>(found)];
}

[[noreturn]] void refuse_energy(const ForceReading& r, const std::string& energy, Variable variable) {
  r.force.refuse(fmt::format(
      "has the energy {}: taut knows harmonic restraints, walls and constant pulls of a distance, an angle "
      "or a "
      "torsion of the first groups{}{}",
      energy,
      variable == Variable::kTorsion ? ", of a torsion 0.5*k*min(d,2*pi-d)^2; d=abs(torsion-phi0)" : "",
      kBiasRemedy));
}

// The variable that an energy of groups names.
Variable variable_of(const std::string& energy) {
  const auto calls = [&](const char* function) { return energy.find(function) != energy.npos; };
  return calls("dihedral(") ? Variable::kTorsion : calls("angle(") ? Variable::kAngle : Variable::kDistance;
}

const char* function_of(Variable variable) {
  return variable == Variable::kTorsion ? "dihedral" : variable == Variable::kAngle ? "angle" : "distance";
}

std::vector<BiasGroup> read_groups(const ForceReading& r) {
  std::vector<BiasGroup> all;
  r.force.part("Groups").each("Group", [&](const Element& group) {
    std::vector<int> atoms;
    std::vector<double> weights;
    group.each("Particle", [&](const Element& particle) {
      std::vector<Field> fields = {atom_field("p", atoms.emplace_back(), r.system.atoms())};
      if (particle.has_attribute("weight")) fields.push_back({"weight", &weights.emplace_back()});
      particle.read_leaf(fields);
    });
    BiasGroup made = make_group(r.system, std::move(atoms));
    if (!weights.empty()) {
      double sum = 0;
      for (const double weight : weights) sum += weight;
      if (weights.size() != made.atoms.size() || !(sum > 0))
        group.refuse("has weights of some of its particles alone, or that add to 0 or less");
      for (double& weight : weights) weight /= sum;
      made.share = std::move(weights);
    }
    all.push_back(std::move(made));
  });
  return all;
}

// Returns the force's name, or nothing where that is its type.
std::string own_name(const Element& force) {
  const std::string name = force.has_attribute("name") ? force.text("name") : "";
  return name == force.text("type") ? "" : name;
}

// Reads the terms of a force on centres, of which `set` makes biases.
template <class Set>
void read_terms(const ForceReading& r, CustomForce& p, int groups, const Set& set) {
  const std::vector<BiasGroup> all = read_groups(r);
  const Element bonds = r.force.part("Bonds");
  bonds.each("Bond", [&](const Element& bond) {
    std::vector<int> of(static_cast<std::size_t>(groups));
    std::vector<Field> fields;
    constexpr std::array kNames = {"g1", "g2", "g3", "g4"};
    for (std::size_t g = 0; g < of.size(); ++g)
      fields.push_back({kNames[g], Field::Integer{&of[g], 0, static_cast<int>(all.size()) - 1}});
    p.read(bond, fields);
    Bias bias;
    if (bonds.count() == 1) bias.name = own_name(r.force);
    set(bias);
    of.resize(static_cast<std::size_t>(groups_of(bias.variable)));
    for (const int g : of) bias.groups.push_back(all[static_cast<std::size_t>(g)]);
    r.to.terms.biases.push_back(std::move(bias));
  });
}

// The component of a separation, as taut writes it.
void read_component(const ForceReading& r, const std::string& energy, bool periodic) {
  std::vector<Quantity> coordinates;
  for (const char* name : {"x1", "y1", "z1", "x2", "y2", "z2"}) coordinates.push_back({name});
  CustomForce p(r, {"PerBondParameters", coordinates}, energy);
  KnownEnergy known{energy, {{"k"}, {"a"}, {"b"}, {"F"}, {"nx"}, {"ny"}, {"nz"}}};
  if (periodic) known.parameters.push_back({"edge"});
  if (p.recognize({known}) < 0) refuse_energy(r, energy, Variable::kComponent);
  read_terms(r, p, 2, [&](Bias& bias) {
    set_all(bias, p);
    bias.variable = Variable::kComponent;
    bias.along = Vec3(p["nx"], p["ny"], p["nz"]);
  });
}

// R_g² as taut writes it: one group, each of whose atoms is a group, too.
Bias read_gyration(const ForceReading& r, const std::string& energy) {
  CustomForce p(r, {"PerBondParameters", {{"v", 0}}}, with_variable(energy, "distance", "g", 2).value());
  const std::vector<BiasGroup> all = read_groups(r);
  Bias bias;
  bias.variable = Variable::kGyration;
  BiasGroup found;
  r.force.part("Bonds").each("Bond", [&](const Element& bond) {
    std::array<int, 2> of{};
    const int last = static_cast<int>(all.size()) - 1;
    p.read(bond, {{"g1", Field::Integer{&of[0], 0, last}}, {"g2", Field::Integer{&of[1], 0, last}}});
    if (bias.groups.empty()) bias.groups.push_back(all[static_cast<std::size_t>(of[0])]);
    const BiasGroup& one = all[static_cast<std::size_t>(of[1])];
    if (all[static_cast<std::size_t>(of[0])].atoms != bias.groups[0].atoms || one.atoms.size() != 1)
      bond.refuse("is no square of a distance of one atom from one group" + std::string(kBiasRemedy));
    found.atoms.push_back(one.atoms[0]);
    found.share.push_back(p.of_term().at(0));
  });
  const auto equal = [](double a, double b) { return std::abs(a - b) < 1e-12; };
  if (bias.groups.empty() || found.atoms != bias.groups[0].atoms ||
      !std::ranges::equal(found.share, bias.groups[0].share, equal))
    r.force.refuse("is no radius of gyration by mass" + std::string(kBiasRemedy));
  return bias;
}

// OpenMM's names for a force on single atoms that is a variable.
struct VariableShape {
  const char *type, *parameters, *list, *each, *energy;
  Variable variable;
};
constexpr std::array kVariableShapes = {
    VariableShape{"CustomBondForce", "PerBondParameters", "Bonds", "Bond", "r", Variable::kDistance},
    VariableShape{"CustomAngleForce", "PerAngleParameters", "Angles", "Angle", "theta", Variable::kAngle},
    VariableShape{"CustomTorsionForce", "PerTorsionParameters", "Torsions", "Torsion", "theta",
                  Variable::kTorsion}};

Bias read_single_atoms(const ForceReading& r, const VariableShape& shape) {
  std::string energy;
  r.read({{"energy", &energy}, {"usesPeriodic", &r.to.takes_images}});
  r.force.check_parts({shape.parameters, "GlobalParameters", "EnergyParameterDerivatives", shape.list});
  const Element terms = r.force.part(shape.list);
  if (energy != shape.energy || terms.count() != 1)
    r.force.refuse(fmt::format("within a CustomCVForce: expected the energy {} of one term, got {} of {}{}",
                               shape.energy, energy, terms.count(), kBiasRemedy));
  Bias bias;
  bias.variable = shape.variable;
  std::array<int, 4> atoms{};
  constexpr std::array kNames = {"p1", "p2", "p3", "p4"};
  std::vector<Field> fields;
  for (int a = 0; a < groups_of(shape.variable); ++a)
    fields.push_back(atom_field(kNames[a], atoms[a], r.system.atoms()));
  terms.each(shape.each, [&](const Element& term) { term.read_leaf(fields); });
  for (int a = 0; a < groups_of(shape.variable); ++a) bias.groups.push_back({{atoms[a]}, {1.0}});
  return bias;
}

// The variable of a CustomCVForce, a force whose energy it is.
Bias read_variable(const ForceReading& r) {
  const std::string type = r.force.text("type");
  for (const VariableShape& shape : kVariableShapes)
    if (type == shape.type) return read_single_atoms(r, shape);
  if (type != "CustomCentroidBondForce")
    r.force.refuse(fmt::format("{} is no collective variable taut has{}", type, kBiasRemedy));
  if (r.force.text("energy") == kSquaresEnergy) {
    std::string energy;
    bool images = false;
    int groups = 0;
    r.read({{"energy", &energy}, {"groups", Field::Integer{&groups, 2, 2}}, {"usesPeriodic", &images}});
    if (images) r.force.refuse("takes nearest images: taut's radius of gyration is that of whole molecules");
    r.force.check_parts({"PerBondParameters", "GlobalParameters", "EnergyParameterDerivatives", "Groups",
                         "Bonds", "Functions"});
    return read_gyration(r, energy);
  }
  OpenMMForce inner;
  read_custom_centroid({r.force, r.system, r.context, inner});
  r.to.takes_images |= inner.takes_images;
  const std::vector<Bias>& found = inner.terms.biases;
  if (found.size() != 1 || found[0].k != 0 || found[0].force != -1)
    r.force.refuse(
        fmt::format("within a CustomCVForce: expected the energy distance(g1,g2), angle(g1,g2,g3) or "
                    "dihedral(g1,g2,g3,g4) of one term{}",
                    kBiasRemedy));
  return {.variable = found[0].variable, .groups = found[0].groups};
}

}  // namespace

void read_custom_centroid(const ForceReading& r) {
  std::string energy;
  int groups = 0;
  r.read(
      {{"energy", &energy}, {"groups", Field::Integer{&groups, 1, 4}}, {"usesPeriodic", &r.to.takes_images}});
  r.force.check_parts({"PerBondParameters", "GlobalParameters", "EnergyParameterDerivatives", "Groups",
                       "Bonds", "Functions"});
  refuse_any(r.force, {"EnergyParameterDerivatives", "Functions"});
  for (const bool periodic : {false, true})
    if (groups == 2 && energy == component_energy(periodic)) return read_component(r, energy, periodic);

  const Variable variable = variable_of(energy);
  if (groups < groups_of(variable)) refuse_energy(r, energy, variable);
  const auto of_v = with_variable(energy, function_of(variable), "g", groups_of(variable));
  if (!of_v) refuse_energy(r, energy, variable);
  CustomForce p(r, {"PerBondParameters", {range_of(variable)}}, *of_v);
  const BiasLaw* law = find_law(p, variable);
  if (!law) refuse_energy(r, energy, variable);
  read_terms(r, p, groups, [&](Bias& bias) {
    bias.variable = variable;
    law->set(bias, p);
  });
}

void read_custom_cv(const ForceReading& r) {
  std::string energy, name;
  r.read({{"energy", &energy}});
  r.force.check_parts({"GlobalParameters", "EnergyParameterDerivatives", "CollectiveVariables", "Functions"});
  refuse_any(r.force, {"EnergyParameterDerivatives", "Functions"});
  const Element variables = r.force.part("CollectiveVariables");
  if (variables.count() != 1)
    r.force.refuse(
        fmt::format("has {} collective variables: taut takes one{}", variables.count(), kBiasRemedy));
  Bias bias;
  variables.each("CollectiveVariable", [&](const Element& variable) {
    variable.read({{"name", &name}});
    variable.check_parts({"Force"});
    bias = read_variable({variable.part("Force"), r.system, r.context, r.to});
  });
  const char* of_v = bias.variable == Variable::kGyration ? "v^2" : "v";
  CustomForce p(r, {nullptr, {range_of(bias.variable)}}, fmt::format("{};{}={}", energy, name, of_v));
  const BiasLaw* law = find_law(p, bias.variable);
  if (!law) refuse_energy(r, energy, bias.variable);
  law->set(bias, p);
  bias.name = own_name(r.force);
  if (bias.name.empty()) bias.name = name;
  r.to.terms.biases.push_back(std::move(bias));
}

}  // namespace taut
