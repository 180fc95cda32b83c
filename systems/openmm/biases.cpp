#include "systems/openmm/biases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "base/errors.hpp"
#include "systems/openmm/writing.hpp"

namespace taut {
namespace {

constexpr const char* kLaw = "0.5*k*(step(v-b)*(v-b)^2+step(a-v)*(a-v)^2)-F*v; v=";

// A force on centres of groups, with the names of what each of its terms says. Terms are added by add_term().
class CentroidForce {
 public:
  CentroidForce(Node to, std::string energy, int groups, bool takes_images, const ParameterNames& names)
      : force_(write_force(to, "CustomCentroidBondForce",
                           {{"energy", &energy}, {"usesPeriodic", &takes_images}})) {
    put(force_, "groups", groups);
    write_parameters(force_, "PerBondParameters", names, {});
    force_.append_child("EnergyParameterDerivatives");
    groups_ = force_.append_child("Groups");
    bonds_ = force_.append_child("Bonds");
    force_.append_child("Functions");
  }

  int add_group(const BiasGroup& group) {
    Node to = groups_.append_child("Group");
    for (std::size_t k = 0; k < group.atoms.size(); ++k) {
      Node particle = to.append_child("Particle");
      put(particle, "p", group.atoms[k]);
      put(particle, "weight", group.share[k]);
    }
    return count_++;
  }

  void add_term(const std::vector<int>& groups, const std::vector<double>& parameters) {
    Node bond = bonds_.append_child("Bond");
    for (std::size_t g = 0; g < groups.size(); ++g) put(bond, fmt::format("g{}", g + 1).c_str(), groups[g]);
    for (std::size_t p = 0; p < parameters.size(); ++p)
      put(bond, fmt::format("param{}", p + 1).c_str(), parameters[p]);
  }

 private:
  Node force_, groups_, bonds_;
  int count_ = 0;
};

NamedValues law_of(const Bias& bias) {
  return {{"k", bias.k},
          {"a", std::max(bias.lower, -kFarWall)},
          {"b", std::min(bias.upper, kFarWall)},
          {"F", bias.force}};
}

// R_g² = Σ w r², of each atom's distance from the centre, is the collective variable s.
void write_gyration(Node to, const Bias& bias) {
  std::string energy = std::string(kLaw) + "sqrt(s)";
  Node force = write_force(to, "CustomCVForce", {{"energy", &energy}});
  write_global_parameters(force, law_of(bias));
  force.append_child("EnergyParameterDerivatives");
  Node variable = force.append_child("CollectiveVariables").append_child("CollectiveVariable");
  put(variable, "name", "s");
  CentroidForce squares(variable, kSquaresEnergy, 2, false, {"w"});
  const BiasGroup& group = bias.groups.front();
  const int centre = squares.add_group(group);
  for (std::size_t k = 0; k < group.atoms.size(); ++k)
    squares.add_term({centre, squares.add_group({{group.atoms[k]}, {1.0}})}, {group.share[k]});
  force.append_child("Functions");
}

std::string energy_of(const Bias& bias, bool periodic) {
  switch (bias.variable) {
    case Bias::Variable::kComponent:
      return component_energy(periodic);
    case Bias::Variable::kAngle:
      return std::string(kLaw) + "angle(g1,g2,g3)";
    case Bias::Variable::kTorsion:
      return std::string(kLaw) +
             "t-turn*floor((t-(a+b)/2)/turn+0.5); t=dihedral(g1,g2,g3,g4); turn=6.283185307179586";
    default:
      return std::string(kLaw) + "distance(g1,g2)";
  }
}

void write_on_centres(Node to, const Bias& bias, const Box& box) {
  NamedValues parameters = law_of(bias);
  if (bias.variable == Bias::Variable::kComponent) {
    const Vec3& n = bias.along;
    parameters.insert(parameters.end(), {{"nx", n.x()}, {"ny", n.y()}, {"nz", n.z()}});
    if (box.periodic()) parameters.emplace_back("edge", n.cwiseAbs().dot(box.edge));
  }
  ParameterNames names;
  std::vector<double> values;
  for (const auto& [name, value] : parameters) names.push_back(name), values.push_back(value);
  CentroidForce force(to, energy_of(bias, box.periodic()), groups_of(bias.variable), box.periodic(), names);
  std::vector<int> groups;
  for (const BiasGroup& group : bias.groups) groups.push_back(force.add_group(group));
  force.add_term(groups, values);
}

}  // namespace

std::string component_energy(bool periodic) {
  return std::string(kLaw) + (periodic ? "c-edge*floor(c/edge+0.5); c=" : "") +
         "nx*(x2-x1)+ny*(y2-y1)+nz*(z2-z1)";
}

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
