#include "systems/openmm/writing.hpp"

#include <algorithm>
#include <map>
#include <type_traits>

#include "systems/openmm/forces.hpp"
#include "systems/openmm/formulas.hpp"
#include "systems/openmm/terms.hpp"

namespace taut {

Node write_force(Node forces, const char* type, const std::vector<Field>& fields) {
  Node force = append(forces, "Force", fields);
  put(force, "type", type);
  put(force, "version", version_written(type));
  put(force, "name", type);
  put(force, "forceGroup", 0);
  return force;
}

void write_parameters(Node force, const char* each, const ParameterNames& of_each,
                      const NamedValues& of_all) {
  Node list = force.append_child(each);
  for (const char* name : of_each) put(list.append_child("Parameter"), "name", name);
  write_global_parameters(force, of_all);
}

void write_global_parameters(Node force, const NamedValues& values) {
  Node list = force.append_child("GlobalParameters");
  for (const auto& [name, value] : values) {
    Node parameter = list.append_child("Parameter");
    put(parameter, "name", name);
    put(parameter, "default", value);
  }
}

void write_term(Node list, const char* name, const std::vector<Field>& atoms,
                const std::vector<double>& parameters) {
  Node term = append(list, name, atoms);
  int n = 0;
  for (const double p : parameters) put(term, fmt::format("param{}", ++n).c_str(), p);
}

void write_spline(Node functions, const std::string& name, const Spline& spline) {
  Node function = functions.append_child("Function");
  double first = spline.first(), last = spline.last();
  put(function, "type", "Continuous1DFunction");
  put(function, "version", 1);
  put(function, "name", name);
  put(function, "min", first);
  put(function, "max", last);
  Node values = function.append_child("Values");
  for (double v : spline.values()) append(values, "Value", {{"v", &v}});
}

void write_discrete(Node functions, const std::string& name, const Eigen::MatrixXd& table) {
  Node function = functions.append_child("Function");
  put(function, "type", "Discrete2DFunction");
  put(function, "version", 1);
  put(function, "name", name);
  put(function, "xsize", table.rows());
  put(function, "ysize", table.cols());
  Node values = function.append_child("Values");
  for (double v : table.reshaped()) append(values, "Value", {{"v", &v}});
}

namespace {

// A force for each table.
template <class Term>
void write_tabulated(Node forces, const std::vector<Term>& terms, const char* formula, int particles) {
  std::map<const Spline*, Node> lists;
  bool takes_images = false;
  for (Term term : terms) {
    const auto [list, fresh] = lists.try_emplace(term.energy.get());
    if (fresh) {
      std::string energy = formula;
      Node force = write_force(forces, "CustomCompoundBondForce",
                               {{"particles", Field::Integer{&particles, 0, 0}},
                                {"energy", &energy},
                                {"usesPeriodic", &takes_images}});
      write_parameters(force, "PerBondParameters", {}, {});
      force.append_child("EnergyParameterDerivatives");
      list->second = force.append_child("Bonds");
      write_spline(force.append_child("Functions"), "table", *term.energy);
    }
    write_term(list->second, "Bond", term_fields(term, 0, {}), {});
  }
}

// The sum of all tables, each times a table of whether two types have it. Beyond its end a function is zero.
void write_tabulated_pairs(Node forces, const TabulatedPairs& pairs, const Box& box) {
  CustomNonbondedXml x{
      .method = box.periodic() ? NonbondedXml::kCutoffPeriodic : NonbondedXml::kCutoffNonPeriodic,
      .cutoff = pairs.cutoff()};
  int types = 1;  // the last: atoms without tables
  for (const auto& [one, two, energy] : pairs.potentials) types = std::max({types, one + 2, two + 2});
  for (std::size_t t = 0; t < pairs.potentials.size(); ++t)
    x.energy += fmt::format("{0}has{1}(type1,type2)*table{1}(r)", t == 0 ? "" : "+", t);
  Node force = write_force(forces, "CustomNonbondedForce", x.fields());
  write_parameters(force, "PerParticleParameters", {"type"}, {});
  force.append_child("EnergyParameterDerivatives");
  Node particles = force.append_child("Particles");
  for (const int kind : pairs.kind)
    write_term(particles, "Particle", {}, {double(kind < 0 ? types - 1 : std::min(kind, types - 1))});
  Node exclusions = force.append_child("Exclusions");
  for (auto pair : pairs.exclusions)
    append(exclusions, InXml<std::array<int, 2>>::kEach, InXml<std::array<int, 2>>::fields(pair, 0));
  Node functions = force.append_child("Functions");
  for (std::size_t t = 0; t < pairs.potentials.size(); ++t) {
    const auto& [one, two, energy] = pairs.potentials[t];
    Eigen::MatrixXd has = Eigen::MatrixXd::Zero(types, types);
    has(one, two) = has(two, one) = 1;
    write_discrete(functions, fmt::format("has{}", t), has);
    write_spline(functions, fmt::format("table{}", t), *energy);
  }
  force.append_child("InteractionGroups");
}

}  // namespace

void write_tables(Node forces, const Terms& terms, const Box& box) {
  write_tabulated(forces, terms.tabulated_bonds, kTableOfDistance, 2);
  write_tabulated(forces, terms.tabulated_angles, kTableOfAngle, 3);
  if (terms.tabulated_pairs) write_tabulated_pairs(forces, *terms.tabulated_pairs, box);
}

}  // namespace taut
