#include "systems/openmm/forces.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <limits>

#include "systems/openmm/terms.hpp"

namespace taut {
namespace {

using Reading = ForceReading;

template <class Term, std::vector<Term> Terms::*kTerms>
void read_bonded(const Reading& r) {
  r.read({{"usesPeriodic", &r.to.takes_images}});
  r.force.check_parts({InXml<Term>::kList});
  read_list(r.force, r.to.terms.*kTerms, r.system.atoms());
}

void read_momentum_remover(const Reading& r) {
  int every = 0;
  r.read({{"frequency", Field::Integer{&every, 1, std::numeric_limits<int>::max()}}});
  r.force.check_parts({});
  r.to.remove_momentum_every = every;
}

// Only noted, because the run settings choose the thermostat.
void read_thermostat(const Reading& r) {
  double temperature = 0, frequency = 0;
  r.read({{"temperature", &temperature}, {"frequency", &frequency}}, {"randomSeed"});
  r.force.check_parts({});
  temperature = r.context.declare(r.force, "AndersenTemperature", temperature);
  frequency = r.context.declare(r.force, "AndersenCollisionFrequency", frequency);
  r.to.notes.push_back(
      fmt::format("({} K, {} collisions per ps) is left to run.thermostat and "
                  "run.temperature_k, which rule",
                  temperature, frequency));
}

void read_cmap(const Reading& r) {
  Terms& t = r.to.terms;
  r.read({{"usesPeriodic", &r.to.takes_images}});
  r.force.check_parts({"Maps", "Torsions"});
  r.force.part("Maps").each("Map", [&](const Element& map) {
    int size = 0;
    map.read({{"size", Field::Integer{&size, 2, 1000}}});
    if (map.count() != static_cast<std::size_t>(size) * size)
      map.refuse(fmt::format("has {} energies, expected {} x {}", map.count(), size, size));
    Eigen::MatrixXd& to = t.maps.emplace_back(size, size);
    double* next = to.data();  // in OpenMM's order, phi first
    map.each_of("Energy", [&](const Element& energy) { energy.read_leaf({{"e", next++}}); });
  });
  read_list(r.force, t.cmaps, r.system.atoms());
}

// Its temperature is that of the thermostat in the run settings.
void read_barostat(const Reading& r) {
  double pressure = 0, temperature = 0;
  int every = 0;
  bool rigid_scaling = true;
  std::vector<Field> fields = {{"pressure", &pressure},
                               {"temperature", &temperature},
                               {"frequency", Field::Integer{&every, 0, std::numeric_limits<int>::max()}}};
  if (r.force.has_attribute("rigidScaling")) fields.push_back({"rigidScaling", &rigid_scaling});
  r.read(fields, {"randomSeed"});
  r.force.check_parts({});
  pressure = r.context.declare(r.force, "MonteCarloPressure", pressure);
  r.context.declare(r.force, "MonteCarloTemperature", temperature);
  if (every == 0) return;
  r.to.barostat = {pressure, every};
  r.to.notes.push_back(fmt::format(
      "({:g} bar, every {} steps) acts where run.thermostat is said, at run.temperature_k", pressure, every));
  if (!rigid_scaling)
    r.to.notes.emplace_back(
        "has rigidScaling=\"0\", which scales atoms one by one: taut scales what rigid bonds connect as a "
        "whole, to the same pressure");
}

void read_particles(const Reading& r, Nonbonded& t) {
  const Element particles = r.force.part("Particles");
  const int n = r.system.atoms();
  r.check_count(particles);
  t.charge.resize(n);
  t.sigma.resize(n);
  t.epsilon.resize(n);
  int a = 0;
  particles.each("Particle", [&](const Element& particle) {
    SiteXml site;
    particle.read_leaf(site.fields());
    t.charge[a] = site.charge;
    t.sigma[a] = site.sigma;
    t.epsilon[a] = site.epsilon;
    ++a;
  });
}

void refuse_unless_carried_out(const Element& force, const NonbondedXml& x) {
  if (x.method == NonbondedXml::kLJPME)
    force.refuse(
        "uses LJPME: taut has NoCutoff, CutoffNonPeriodic, CutoffPeriodic, Ewald and PME; Lennard-Jones is "
        "cut off, "
        "with a dispersion correction if asked for");
  if (!x.direct_space) force.refuse("leaves its direct space out: taut does not");
  for (const char* list : NonbondedXml::kEmpty)
    if (force.part(list).count() > 0)
      force.part(list).refuse(
          fmt::format("has global parameters and offsets ({}): taut has fixed parameters", list));
}

void read_nonbonded(const Reading& r) {
  Nonbonded& t = r.to.terms.nonbonded.emplace();
  NonbondedXml x;
  std::vector<std::string_view> unused;
  for (const auto& [name, value] : NonbondedXml::kUnused) unused.emplace_back(name);
  r.read(x.fields(), unused);
  r.force.check_parts({"GlobalParameters", "ParticleOffsets", "ExceptionOffsets", "Particles", "Exceptions"});
  refuse_unless_carried_out(r.force, x);
  read_particles(r, t);
  read_list(r.force, t.exceptions, r.system.atoms());

  // OpenMM ignores the switch and the dielectric constant without a cutoff, and the dispersion correction
  // without a box.
  r.to.takes_images = x.takes_images;
  // It uses a grid only together with an alpha.
  r.to.periodic_pairs = x.method >= NonbondedXml::kCutoffPeriodic;
  const bool by_tolerance = x.method == NonbondedXml::kEwald || x.pme.alpha == 0;
  if (x.method == NonbondedXml::kPME || x.method == NonbondedXml::kEwald)
    t.pme = by_tolerance ? PmeParameters{.tolerance = x.pme.tolerance} : x.pme;
  if (x.method == NonbondedXml::kEwald)
    r.to.notes.push_back(
        fmt::format("is summed by PME, as exact as its plain Ewald sum: to {}", x.pme.tolerance));
  t.rf_dielectric = x.rf_dielectric;
  t.dispersion_correction = x.dispersion_correction && *r.to.periodic_pairs;
  if (x.method == NonbondedXml::kNoCutoff) return;
  t.cutoff = x.cutoff;
  if (x.switched) t.switch_distance = x.switch_distance;
}

// For each force, the version that OpenMM 7.7 writes, which 8.6 reads, too, and the one that 8.6 writes.
struct ForceKind {
  const char* type;
  int oldest, newest;
  void (*read)(const Reading&);
};
constexpr std::array kForceKinds = {
    ForceKind{InXml<HarmonicBond>::kForce, 2, 2, read_bonded<HarmonicBond, &Terms::bonds>},
    ForceKind{InXml<HarmonicAngle>::kForce, 2, 2, read_bonded<HarmonicAngle, &Terms::angles>},
    ForceKind{InXml<PeriodicTorsion>::kForce, 2, 2, read_bonded<PeriodicTorsion, &Terms::torsions>},
    ForceKind{InXml<RyckaertBellemans>::kForce, 2, 2, read_bonded<RyckaertBellemans, &Terms::rb_torsions>},
    ForceKind{"CMAPTorsionForce", 2, 2, read_cmap},
    ForceKind{"NonbondedForce", 4, 4, read_nonbonded},
    ForceKind{"CMMotionRemover", 1, 1, read_momentum_remover},
    ForceKind{"AndersenThermostat", 1, 1, read_thermostat},
    ForceKind{"MonteCarloBarostat", 1, 1, read_barostat},
    ForceKind{"CustomBondForce", 3, 3, read_custom_bonds},
    ForceKind{"CustomAngleForce", 3, 3, read_custom_angles},
    ForceKind{"CustomTorsionForce", 3, 3, read_custom_torsions},
    ForceKind{"CustomCompoundBondForce", 3, 3, read_custom_compound},
    ForceKind{"CustomCentroidBondForce", 3, 3, read_custom_centroid},
    ForceKind{"CustomCVForce", 0, 0, read_custom_cv},
    ForceKind{"CustomExternalForce", 1, 1, read_custom_external},
    ForceKind{"CustomNonbondedForce", 2, 3, read_custom_nonbonded},
};

constexpr auto kind_named(std::string_view type) {
  return std::find_if(kForceKinds.begin(), kForceKinds.end(),
                      [&](const ForceKind& k) { return k.type == type; });
}

const ForceKind& kind_of(const Element& force) {
  const std::string type = force.text("type");
  if (type.starts_with("MonteCarlo") && type != "MonteCarloBarostat")
    force.refuse(
        "is a barostat taut has not: take it out, and say run.barostat = \"c-rescale\" with run.coupling = "
        "\"anisotropic\" or \"semi-isotropic\"");
  const auto kind = kind_named(type);
  if (kind == kForceKinds.end()) {
    std::vector<std::string_view> known;
    for (const ForceKind& k : kForceKinds) known.emplace_back(k.type);
    force.refuse(fmt::format("is not one taut knows: it has {}", fmt::join(known, ", ")));
  }
  const std::string version = force.text("version");
  if (version != std::to_string(kind->oldest) && version != std::to_string(kind->newest))
    force.refuse(fmt::format("has version=\"{}\", expected {}: OpenMM 7.7 to 8.6 write files that taut reads",
                             version, kind->newest));
  return *kind;
}

}  // namespace

double ContextParameters::declare(const Element& at, const std::string& name, double default_value) {
  const auto [known, is_new] = defaults_.emplace(name, default_value);
  if (!is_new && known->second != default_value)
    at.refuse(fmt::format("global parameter {} is {} by default, but {} in another force", name,
                          default_value, known->second));
  const auto given = of_state_.find(name);
  return given == of_state_.end() ? default_value : given->second;
}

std::optional<std::string> ContextParameters::undeclared() const {
  for (const auto& [name, value] : of_state_)
    if (!defaults_.contains(name)) return name;
  return std::nullopt;
}

void ForceReading::read(const std::vector<Field>& fields, std::vector<std::string_view> unused) const {
  unused.insert(unused.end(), {"forceGroup", "name", "type", "version"});
  force.read(fields, unused);
}

void ForceReading::check_count(const Element& particles) const {
  if (particles.count() != static_cast<std::size_t>(system.atoms()))
    particles.refuse(
        fmt::format("has {} particles, the system has {} atoms", particles.count(), system.atoms()));
}

int version_written(std::string_view type) {
  return kind_named(type)->oldest;
}

OpenMMForce read_force(const Element& force, const System& system, ContextParameters& context) {
  OpenMMForce to;
  kind_of(force).read({force, system, context, to});
  return to;
}

}  // namespace taut
