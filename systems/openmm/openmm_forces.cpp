#include "systems/openmm/openmm_forces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "forcefield/check_terms.hpp"
#include "md/errors.hpp"

namespace taut {
namespace {

using Integer = Field::Integer;

using Reading = ForceReading;

void read_bonds(const Reading& r) {
  r.read({{"usesPeriodic", &r.to.takes_images}});
  r.force.check_parts({"Bonds"});
  r.force.part("Bonds").each("Bond", [&](const Element& bond) {
    HarmonicBond t{};
    bond.read_leaf({{"p1", r.atom(t.i)}, {"p2", r.atom(t.j)}, {"d", &t.length}, {"k", &t.k}});
    r.to.terms.bonds.push_back(t);
  });
}

void read_angles(const Reading& r) {
  r.read({{"usesPeriodic", &r.to.takes_images}});
  r.force.check_parts({"Angles"});
  r.force.part("Angles").each("Angle", [&](const Element& angle) {
    HarmonicAngle t{};
    angle.read_leaf({{"p1", r.atom(t.i)},
                     {"p2", r.atom(t.j)},
                     {"p3", r.atom(t.k)},
                     {"a", &t.angle},
                     {"k", &t.stiffness}});
    r.to.terms.angles.push_back(t);
  });
}

void read_torsions(const Reading& r) {
  r.read({{"usesPeriodic", &r.to.takes_images}});
  r.force.check_parts({"Torsions"});
  r.force.part("Torsions").each("Torsion", [&](const Element& torsion) {
    PeriodicTorsion t{};
    torsion.read_leaf({{"p1", r.atom(t.i)},
                       {"p2", r.atom(t.j)},
                       {"p3", r.atom(t.k)},
                       {"p4", r.atom(t.l)},
                       {"periodicity", Integer{&t.periodicity, 1, kMostPeriodicity}},
                       {"phase", &t.phase},
                       {"k", &t.amplitude}});
    r.to.terms.torsions.push_back(t);
  });
}

void read_rb_torsions(const Reading& r) {
  r.read({{"usesPeriodic", &r.to.takes_images}});
  r.force.check_parts({"Torsions"});
  r.force.part("Torsions").each("Torsion", [&](const Element& torsion) {
    RyckaertBellemans t{};
    torsion.read_leaf({{"p1", r.atom(t.i)},
                       {"p2", r.atom(t.j)},
                       {"p3", r.atom(t.k)},
                       {"p4", r.atom(t.l)},
                       {"c0", &t.c[0]},
                       {"c1", &t.c[1]},
                       {"c2", &t.c[2]},
                       {"c3", &t.c[3]},
                       {"c4", &t.c[4]},
                       {"c5", &t.c[5]}});
    r.to.terms.rb_torsions.push_back(t);
  });
}

void read_momentum_remover(const Reading& r) {
  int every = 0;
  r.read({{"frequency", Integer{&every, 1, std::numeric_limits<int>::max()}}});
  r.force.check_parts({});
  r.to.remove_momentum_every = every;
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
    particle.read_leaf({{"q", &t.charge[a]}, {"sig", &t.sigma[a]}, {"eps", &t.epsilon[a]}});
    ++a;
  });
}

void read_exceptions(const Reading& r, Nonbonded& t) {
  r.force.part("Exceptions").each("Exception", [&](const Element& exception) {
    auto& [i, j, charge_product, sigma, epsilon] = t.exceptions.emplace_back();
    exception.read_leaf(
        {{"p1", r.atom(i)}, {"p2", r.atom(j)}, {"q", &charge_product}, {"sig", &sigma}, {"eps", &epsilon}});
  });
}

enum Method { kNoCutoff, kCutoffNonPeriodic, kCutoffPeriodic, kEwald, kPME, kLJPME };

void refuse_unless_carried_out(const Element& force, int method, bool direct_space) {
  constexpr std::array kNames = {"NoCutoff", "CutoffNonPeriodic", "CutoffPeriodic", "Ewald", "PME", "LJPME"};
  if (method > kCutoffPeriodic)
    force.refuse(fmt::format("uses {}: taut has NoCutoff, CutoffNonPeriodic and CutoffPeriodic",
                             kNames.at(static_cast<std::size_t>(method))));
  if (!direct_space) force.refuse("leaves its direct space out: taut does not");
  for (const char* list : {"GlobalParameters", "ParticleOffsets", "ExceptionOffsets"})
    if (force.part(list).count() > 0)
      force.part(list).refuse(
          fmt::format("has global parameters and offsets ({}): taut has fixed parameters", list));
}

void read_nonbonded(const Reading& r) {
  Nonbonded& t = r.to.terms.nonbonded.emplace();
  int method = 0;
  bool switched = false, direct_space = true;
  double cutoff = 0, switch_distance = 0;
  r.read({{"method", Integer{&method, kNoCutoff, kLJPME}},
          {"cutoff", &cutoff},
          {"rfDielectric", &t.rf_dielectric},
          {"useSwitchingFunction", &switched},
          {"switchingDistance", &switch_distance},
          {"dispersionCorrection", &t.dispersion_correction},
          {"exceptionsUsePeriodic", &r.to.takes_images},
          {"includeDirectSpace", &direct_space}},
         {"recipForceGroup",  // and more of PME
          "ewaldTolerance", "alpha", "nx", "ny", "nz", "ljAlpha", "ljnx", "ljny", "ljnz"});
  r.force.check_parts({"GlobalParameters", "ParticleOffsets", "ExceptionOffsets", "Particles", "Exceptions"});
  refuse_unless_carried_out(r.force, method, direct_space);
  read_particles(r, t);
  read_exceptions(r, t);

  // OpenMM ignores switch and dielectric without a cutoff, and the dispersion correction without a box.
  r.to.periodic_pairs = method == kCutoffPeriodic;
  t.dispersion_correction = t.dispersion_correction && method == kCutoffPeriodic;
  if (method == kNoCutoff) return;
  t.cutoff = cutoff;
  if (switched) t.switch_distance = switch_distance;
}

// With the version OpenMM 7.7 writes, and that of 8.6.
struct Kind {
  const char* type;
  int oldest, newest;
  void (*read)(const Reading&);
};
constexpr std::array kKinds = {
    Kind{"HarmonicBondForce", 2, 2, read_bonds},
    Kind{"HarmonicAngleForce", 2, 2, read_angles},
    Kind{"PeriodicTorsionForce", 2, 2, read_torsions},
    Kind{"RBTorsionForce", 2, 2, read_rb_torsions},
    Kind{"NonbondedForce", 4, 4, read_nonbonded},
    Kind{"CMMotionRemover", 1, 1, read_momentum_remover},
    Kind{"CustomBondForce", 3, 3, read_custom_bonds},
    Kind{"CustomExternalForce", 1, 1, read_custom_external},
    Kind{"CustomNonbondedForce", 2, 3, read_custom_nonbonded},
};

const Kind& kind_of(const Element& force) {
  const std::string type = force.text("type");
  const auto kind = std::find_if(kKinds.begin(), kKinds.end(), [&](const Kind& k) { return k.type == type; });
  if (kind == kKinds.end()) {
    std::vector<std::string_view> known;
    for (const Kind& k : kKinds) known.emplace_back(k.type);
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

OpenMMForce read_force(const Element& force, const System& system, ContextParameters& context) {
  OpenMMForce to;
  kind_of(force).read({force, system, context, to});
  return to;
}

}  // namespace taut
