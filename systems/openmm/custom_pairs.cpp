#include <fmt/format.h>

#include <cmath>
#include <map>

#include "systems/openmm/custom.hpp"
#include "systems/openmm/terms.hpp"

namespace taut {
namespace {

constexpr std::size_t kMostTypes = 500;
// CHARMM's force switch is an energy of its own.
constexpr const char* kRemedy = "; to switch Lennard-Jones off give the force a switchingDistance";

const std::vector<KnownEnergy>& known() {
  static const std::vector<KnownEnergy> kAll = {{kWcaEnergy, {{"sigma", 0.41, 0.47}, {"epsilon"}}},
                                                {kLennardJonesEnergy, {}}};  // known by its values, below
  return kAll;
}

// OpenMM's discrete functions, which round their arguments.
Expression::Tables read_tables(const Element& force) {
  Expression::Tables tables;
  force.part("Functions").each("Function", [&](const Element& function) {
    std::string name, type;
    int x = 0, y = 1;
    const auto size = [](const char* of, int& to) { return Field{of, Field::Integer{&to, 1, 10'000}}; };
    type = function.text("type");
    std::vector<Field> fields = {{"name", &name}, {"type", &type}};
    if (type == "Discrete2DFunction")
      fields.insert(fields.end(), {size("xsize", x), size("ysize", y)});
    else if (type != "Discrete1DFunction")
      function.refuse(
          fmt::format("has the function {} of a kind ({}) taut does not know: it has "
                      "Discrete1DFunction and Discrete2DFunction",
                      function.text("name"), type));
    function.read(fields, {"version"});
    function.check_parts({"Values"});
    std::vector<double> values;
    function.part("Values").each("Value", [&](const Element& value) {
      value.read_leaf({{"v", &values.emplace_back()}});
    });
    const bool plane = type == "Discrete2DFunction";
    if (!plane) x = static_cast<int>(values.size());
    if (values.size() != static_cast<std::size_t>(x) * y)
      function.refuse(fmt::format("has {} values, expected {} x {}", values.size(), x, y));
    tables[name] = {plane ? 2 : 1, [=](std::span<const double> at) {
                      const double i = std::round(at[0]), j = plane ? std::round(at[1]) : 0;
                      if (!(i >= 0 && i < x && j >= 0 && j < y)) return std::nan("");
                      return values[static_cast<std::size_t>(i) + static_cast<std::size_t>(j) * x];
                    }};
  });
  return tables;
}

// Finds a and b of an energy a/r¹² − b/r⁶: b from a large distance, a from a small one. Between them the
// energy must agree.
struct PowerLaw {
  bool fits = true;
  double a, b;

  template <class Energy>
  explicit PowerLaw(const Energy& energy) {
    const auto inv_r6 = [](double r) { return std::pow(r, -6); };
    constexpr double kFar = 1e3, kClose = 1e-3;  // [nm]
    b = -energy(kFar) / inv_r6(kFar);
    a = (energy(kClose) / inv_r6(kClose) + b) / inv_r6(kClose);
    if (std::abs(a) < 1e-20 * std::abs(b)) a = 0;  // a is rounding error
    if (std::abs(b) < 1e-12 * std::abs(a)) b = 0;
    for (const double r : {0.02, 0.1, 0.17, 0.25, 0.33, 0.41, 0.6, 0.9, 1.2, 3.0}) {
      const double u = inv_r6(r);
      fits = fits && std::abs(energy(r) - (a * u - b) * u) <= 1e-9 * (std::abs(a * u) + std::abs(b)) * u;
    }
  }
};

void read_wca(const ForceReading& r, CustomForce& p, const CustomNonbondedXml& x) {
  Wca& wca = r.to.terms.wca.emplace(Wca{p.of_all("sigma"), p.factor() * p.of_all("epsilon"), {}});
  if (x.method == NonbondedXml::kNoCutoff || !(std::abs(x.cutoff - wca.cutoff()) < 1e-12 * wca.sigma))
    r.force.refuse("is not cut off at 2^(1/6) sigma, as taut's repulsive beads are");
  if (x.switched) r.force.refuse("has useSwitchingFunction=\"1\": taut's repulsive beads have no switch");
  if (x.corrected) r.force.refuse("has useLongRangeCorrection=\"1\": nothing is beyond the cutoff");
  r.force.part("Particles").each("Particle", [&](const Element& particle) { p.read(particle, {}); });
  read_list(r.force, wca.exclusions, r.system.atoms());
}

void read_types(const ForceReading& r, CustomForce& p, LennardJonesTable& table) {
  std::map<std::vector<double>, int> types;
  r.force.part("Particles").each("Particle", [&](const Element& particle) {
    p.read(particle, {});
    table.type.push_back(types.emplace(p.of_term(), static_cast<int>(types.size())).first->second);
    if (types.size() > kMostTypes)
      particle.refuse(fmt::format(
          "is of a type of its own, as are more than {} atoms: taut takes no more types", kMostTypes));
  });
  const auto n = static_cast<Eigen::Index>(types.size());
  table.a = table.b = Eigen::MatrixXd::Zero(n, n);
  for (const auto& one : types)
    for (const auto& two : types) {
      const PowerLaw law([&](double at) { return p.pair_energy(one.first, two.first, at); });
      if (!law.fits) p.refuse_energy(known(), kRemedy);
      table.a(one.second, two.second) = law.a;
      table.b(one.second, two.second) = law.b;
    }
  const auto uneven = [](const Eigen::MatrixXd& m) {
    return ((m - m.transpose()).array().abs() > 1e-12 * m.array().abs()).any();
  };
  if (uneven(table.a) || uneven(table.b))
    r.force.refuse("has another energy between two atoms when they are named the other way round");
}

void read_lennard_jones(const ForceReading& r, CustomForce& p, const CustomNonbondedXml& x) {
  Nonbonded& lj = r.to.lennard_jones.emplace();
  read_types(r, p, lj.lj_table.emplace());
  std::vector<std::array<int, 2>> exclusions;
  read_list(r.force, exclusions, r.system.atoms());
  for (const auto& [i, j] : exclusions) lj.exceptions.push_back({i, j, 0, 1, 0});
  lj.dispersion_correction = x.corrected && *r.to.periodic_pairs;
  if (x.method == NonbondedXml::kNoCutoff) return;
  lj.cutoff = x.cutoff;
  if (x.switched) lj.switch_distance = x.switch_distance;
}

}  // namespace

void read_custom_nonbonded(const ForceReading& r) {
  CustomNonbondedXml x;
  r.read(x.fields());
  r.force.check_parts({"PerParticleParameters", "GlobalParameters", "EnergyParameterDerivatives", "Particles",
                       "Exclusions", "Functions", "InteractionGroups"},
                      {"ComputedValues"});  // from version 3 on
  refuse_any(r.force, {"EnergyParameterDerivatives", "ComputedValues", "InteractionGroups"});
  r.check_count(r.force.part("Particles"));
  r.to.periodic_pairs = x.method == NonbondedXml::kCutoffPeriodic;
  CustomForce p(r, {"PerParticleParameters", {{"r", 0.3, 0.45}}, true}, x.energy, read_tables(r.force));
  p.recognize({known().front()}) == 0 ? read_wca(r, p, x) : read_lennard_jones(r, p, x);
}

}  // namespace taut
