#include "systems/openmm/biases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "base/errors.hpp"

namespace taut {
namespace {

using Node = pugi::xml_node;
using Parameters = std::vector<std::pair<const char*, double>>;

// A wall where there is none, which no value reaches.
constexpr double kFar = 1e6;

constexpr const char* kLaw = "0.5*k*(step(v-b)*(v-b)^2+step(a-v)*(a-v)^2)-F*v; v=";

void set_attribute(Node node, const char* name, const auto& value) {
  node.append_attribute(name) = fmt::format("{}", value).c_str();
}

Node write_force(Node to, const char* type, const char* version, const std::string& energy) {
  Node force = to.append_child("Force");
  set_attribute(force, "type", type);
  set_attribute(force, "version", version);
  set_attribute(force, "name", type);
  set_attribute(force, "forceGroup", 0);
  set_attribute(force, "energy", energy);
  return force;
}

void write_globals(Node force, const Parameters& parameters) {
  Node list = force.append_child("GlobalParameters");
  for (const auto& [name, value] : parameters) {
    Node parameter = list.append_child("Parameter");
    set_attribute(parameter, "name", name);
    set_attribute(parameter, "default", value);
  }
  force.append_child("EnergyParameterDerivatives");
}

// A force on centres of groups, with the names of what each of its terms says. Terms are added by add_term().
class CentroidForce {
 public:
  CentroidForce(Node to, const std::string& energy, int groups, bool takes_images,
                const std::vector<const char*>& names)
      : force_(write_force(to, "CustomCentroidBondForce", "3", energy)) {
    set_attribute(force_, "usesPeriodic", takes_images ? 1 : 0);
    set_attribute(force_, "groups", groups);
    Node list = force_.append_child("PerBondParameters");
    for (const char* name : names) set_attribute(list.append_child("Parameter"), "name", name);
    write_globals(force_, {});
    groups_ = force_.append_child("Groups");
    bonds_ = force_.append_child("Bonds");
    force_.append_child("Functions");
  }

  int add_group(const BiasGroup& group) {
    Node to = groups_.append_child("Group");
    for (std::size_t k = 0; k < group.atoms.size(); ++k) {
      Node particle = to.append_child("Particle");
      set_attribute(particle, "p", group.atoms[k]);
      set_attribute(particle, "weight", group.share[k]);
    }
    return count_++;
  }

  void add_term(const std::vector<int>& groups, const std::vector<double>& parameters) {
    Node bond = bonds_.append_child("Bond");
    for (std::size_t g = 0; g < groups.size(); ++g)
      set_attribute(bond, fmt::format("g{}", g + 1).c_str(), groups[g]);
    for (std::size_t p = 0; p < parameters.size(); ++p)
      set_attribute(bond, fmt::format("param{}", p + 1).c_str(), parameters[p]);
  }

 private:
  Node force_, groups_, bonds_;
  int count_ = 0;
};

Parameters law_of(const Bias& bias) {
  return {{"k", bias.k},
          {"a", std::max(bias.lower, -kFar)},
          {"b", std::min(bias.upper, kFar)},
          {"F", bias.force}};
}

// R_g² = Σ w r², of each atom's distance from the centre, is the collective variable s.
void write_gyration(Node to, const Bias& bias) {
  Node force = write_force(to, "CustomCVForce", "0", std::string(kLaw) + "sqrt(s)");
  write_globals(force, law_of(bias));
  Node variable = force.append_child("CollectiveVariables").append_child("CollectiveVariable");
  set_attribute(variable, "name", "s");
  CentroidForce squares(variable, "w*distance(g1,g2)^2", 2, false, {"w"});
  const BiasGroup& group = bias.groups.front();
  const int centre = squares.add_group(group);
  for (std::size_t k = 0; k < group.atoms.size(); ++k)
    squares.add_term({centre, squares.add_group({{group.atoms[k]}, {1.0}})}, {group.share[k]});
  force.append_child("Functions");
}

std::string text_of(const Bias& bias, bool periodic) {
  switch (bias.variable) {
    case Bias::Variable::kComponent:
      return std::string(periodic ? "c-edge*floor(c/edge+0.5); c=" : "") + "nx*(x2-x1)+ny*(y2-y1)+nz*(z2-z1)";
    case Bias::Variable::kAngle:
      return "angle(g1,g2,g3)";
    case Bias::Variable::kTorsion:
      return "t-turn*floor((t-(a+b)/2)/turn+0.5); t=dihedral(g1,g2,g3,g4); turn=6.283185307179586";
    default:
      return "distance(g1,g2)";
  }
}

void write_on_centres(Node to, const Bias& bias, const Box& box) {
  Parameters parameters = law_of(bias);
  if (bias.variable == Bias::Variable::kComponent) {
    const Vec3& n = bias.along;
    parameters.insert(parameters.end(), {{"nx", n.x()}, {"ny", n.y()}, {"nz", n.z()}});
    if (box.periodic()) parameters.emplace_back("edge", n.cwiseAbs().dot(box.edge));
  }
  std::vector<const char*> names;
  std::vector<double> values;
  for (const auto& [name, value] : parameters) names.push_back(name), values.push_back(value);
  CentroidForce force(to, kLaw + text_of(bias, box.periodic()), groups_of(bias.variable), box.periodic(),
                      names);
  std::vector<int> groups;
  for (const BiasGroup& group : bias.groups) groups.push_back(force.add_group(group));
  force.add_term(groups, values);
}

}  // namespace

void write_biases(Node forces, const std::vector<Bias>& biases, const Box& box) {
  for (const Bias& bias : biases) {
    if (bias.rate != 0)
      throw InputError(fmt::format(
          "OpenMM cannot express it: bias {} moves, and OpenMM's forces do not depend on time; leave out "
          "its rate",
          bias.name));
    if (bias.variable == Bias::Variable::kGyration)
      write_gyration(forces, bias);
    else
      write_on_centres(forces, bias, box);
  }
}

}  // namespace taut
