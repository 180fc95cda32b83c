#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "systems/openmm/openmm_expressions.hpp"
#include "systems/openmm/openmm_forces.hpp"
#include "systems/openmm/openmm_terms.hpp"

namespace taut {
namespace {

// The parameters of a custom force by the names it declares: of each term (its param1, param2, ...) or of
// all.
class Parameters {
 public:
  Parameters(const Element& force, const char* of_each, ContextParameters& context) : force_(force) {
    force.part(of_each).each("Parameter", [&](const Element& parameter) {
      std::string name;
      parameter.read_leaf({{"name", &name}});
      add(parameter, name, 0);
      of_each_.push_back({fmt::format("param{}", of_each_.size() + 1), name});
    });
    force.part("GlobalParameters").each("Parameter", [&](const Element& parameter) {
      std::string name;
      double value = 0;
      parameter.read_leaf({{"name", &name}, {"default", &value}});
      add(parameter, name, context.declare(parameter, name, value));
    });
  }

  // Reads a term: its own fields, and the parameters it gives.
  void read(const Element& term, std::vector<Field> fields) {
    for (const auto& [attribute, name] : of_each_) fields.push_back({attribute, &values_.at(name)});
    term.read_leaf(fields);
  }

  // That of the term last read, or of all.
  double operator[](const std::string& name) const {
    const auto at = values_.find(name);
    if (at == values_.end()) force_.refuse(fmt::format("does not declare {}, which its energy names", name));
    return at->second;
  }

  double of_all(const std::string& name) const {
    for (const auto& [attribute, each] : of_each_)
      if (each == name) force_.refuse(fmt::format("declares {} of each particle, expected of all", name));
    return (*this)[name];
  }

 private:
  struct OfEach {
    std::string attribute, name;
  };

  void add(const Element& at, const std::string& name, double value) {
    if (name == "r" || name == "x" || name == "y" || name == "z")
      at.refuse(fmt::format("declares {}, which is a coordinate", name));
    if (!values_.emplace(name, value).second) at.refuse(fmt::format("declares {} a second time", name));
  }

  const Element& force_;
  std::vector<OfEach> of_each_;
  std::map<std::string, double> values_;
};

void check_energy(const Element& force, const std::string& energy, std::vector<std::string_view> known) {
  if (std::find(known.begin(), known.end(), energy) == known.end())
    force.refuse(fmt::format("has the energy {}: taut knows {}", energy, fmt::join(known, " and ")));
}

void refuse_any(const Element& force, std::initializer_list<const char*> lists) {
  for (const char* list : lists)
    if (force.has(list) && force.part(list).count() > 0)
      force.part(list).refuse(fmt::format("has {}: taut carries out none", list));
}

void read_gravity(const ForceReading& r, Parameters& p) {
  std::vector<bool> moved(static_cast<std::size_t>(r.system.atoms()));
  r.force.part("Particles").each("Particle", [&](const Element& particle) {
    int atom = 0;
    p.read(particle, {atom_field("index", atom, r.system.atoms())});
    const auto a = static_cast<std::size_t>(atom);
    if (p["mass"] != r.system.mass[atom])
      particle.refuse(fmt::format("pulls on atom {} by another mass than its own", atom));
    if (moved[a]) particle.refuse(fmt::format("pulls on atom {} twice", atom));
    moved[a] = true;
  });
  for (std::size_t a = 0; a < moved.size(); ++a)
    if (r.system.mass[static_cast<int>(a)] > 0 && !moved[a])
      r.force.refuse(fmt::format("leaves atom {} out: taut's gravity acts on all", a));
  r.to.terms.gravity = Vec3(p.of_all("gx"), p.of_all("gy"), p.of_all("gz"));
}

void read_pulls(const ForceReading& r, Parameters& p) {
  r.force.part("Particles").each("Particle", [&](const Element& particle) {
    Pull pull{};
    p.read(particle, {atom_field("index", pull.atom, r.system.atoms())});
    pull.force = Vec3(p["fx"], p["fy"], p["fz"]);
    r.to.terms.pulls.push_back(pull);
  });
}

}  // namespace

void read_custom_external(const ForceReading& r) {
  std::string energy;
  r.read({{"energy", &energy}});
  r.force.check_parts({"PerParticleParameters", "GlobalParameters", "Particles"});
  check_energy(r.force, energy, {kGravityEnergy, kPullEnergy});
  Parameters p(r.force, "PerParticleParameters", r.context);
  energy == kGravityEnergy ? read_gravity(r, p) : read_pulls(r, p);
}

void read_custom_bonds(const ForceReading& r) {
  std::string energy;
  r.read({{"energy", &energy}, {"usesPeriodic", &r.to.takes_images}});
  r.force.check_parts({"PerBondParameters", "GlobalParameters", "EnergyParameterDerivatives", "Bonds"});
  check_energy(r.force, energy, {kFeneEnergy});
  refuse_any(r.force, {"EnergyParameterDerivatives"});
  Parameters p(r.force, "PerBondParameters", r.context);
  r.force.part("Bonds").each("Bond", [&](const Element& bond) {
    Fene t{};
    p.read(bond, {atom_field("p1", t.i, r.system.atoms()), atom_field("p2", t.j, r.system.atoms())});
    t.k = p["k"];
    t.r0 = p["r0"];
    r.to.terms.fene.push_back(t);
  });
}

void read_custom_nonbonded(const ForceReading& r) {
  CustomNonbondedXml x;
  r.read(x.fields(), {"switchingDistance"});
  r.force.check_parts({"PerParticleParameters", "GlobalParameters", "EnergyParameterDerivatives", "Particles",
                       "Exclusions", "Functions", "InteractionGroups"},
                      {"ComputedValues"});  // from version 3 on
  check_energy(r.force, x.energy, {kWcaEnergy});
  refuse_any(r.force, {"EnergyParameterDerivatives", "ComputedValues", "Functions", "InteractionGroups"});
  Parameters p(r.force, "PerParticleParameters", r.context);

  Wca& wca = r.to.terms.wca.emplace(Wca{p.of_all("sigma"), p.of_all("epsilon"), {}});
  if (x.method == NonbondedXml::kNoCutoff || !(std::abs(x.cutoff - wca.reach()) < 1e-12 * wca.sigma))
    r.force.refuse("is not cut off at 2^(1/6) sigma, as taut's repulsive beads are");
  if (x.switched) r.force.refuse("has useSwitchingFunction=\"1\": taut's repulsive beads have no switch");
  if (x.corrected) r.force.refuse("has useLongRangeCorrection=\"1\": nothing is beyond the cutoff");
  r.to.periodic_pairs = x.method == NonbondedXml::kCutoffPeriodic;

  r.check_count(r.force.part("Particles"));
  r.force.part("Particles").each("Particle", [&](const Element& particle) { p.read(particle, {}); });
  read_list(r.force, wca.exclusions, r.system.atoms());
}

}  // namespace taut
