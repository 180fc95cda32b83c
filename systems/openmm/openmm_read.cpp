#include "systems/openmm/openmm_read.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "md/errors.hpp"
#include "systems/openmm/openmm_custom.hpp"
#include "systems/openmm/openmm_files.hpp"
#include "systems/whole_molecules.hpp"

// Periodic bonded forces and exceptions need no images here: with every molecule whole, the atoms of a term
// are where the nearest images would be, as long as they belong to one molecule (checked).

namespace taut {
namespace {

constexpr std::array kKnownForces = {"HarmonicBondForce", "HarmonicAngleForce",  "PeriodicTorsionForce",
                                     "RBTorsionForce",    "NonbondedForce",      "CMMotionRemover",
                                     "CustomBondForce",   "CustomExternalForce", "CustomNonbondedForce"};

// One force of the file, to say what is wrong with it.
class Origin {
 public:
  Origin(const OpenMMFile& file, int index, int atoms) : file_(file), index_(index), atoms_(atoms) {}

  [[noreturn]] void refuse(const std::string& why) const {
    const auto& [type, line] = file_.forces[index_];
    file_.refuse(line, fmt::format("force {}: {} {}", index_, type, why));
  }

  void check(std::initializer_list<int> term, const char* kind, int k) const {
    for (const int a : term)
      if (a < 0 || a >= atoms_)
        refuse(fmt::format("{} {} names atom {}, the system has atoms 0 to {}", kind, k, a, atoms_ - 1));
  }

 private:
  const OpenMMFile& file_;
  int index_, atoms_;
};

void add(const OpenMM::HarmonicBondForce& force, const Origin& origin, OpenMMInput& input) {
  for (int b = 0; b < force.getNumBonds(); ++b) {
    HarmonicBond t{};
    force.getBondParameters(b, t.i, t.j, t.length, t.k);
    origin.check({t.i, t.j}, "bond", b);
    input.terms.bonds.push_back(t);
  }
}

void add(const OpenMM::HarmonicAngleForce& force, const Origin& origin, OpenMMInput& input) {
  for (int a = 0; a < force.getNumAngles(); ++a) {
    HarmonicAngle t{};
    force.getAngleParameters(a, t.i, t.j, t.k, t.angle, t.stiffness);
    origin.check({t.i, t.j, t.k}, "angle", a);
    input.terms.angles.push_back(t);
  }
}

void add(const OpenMM::PeriodicTorsionForce& force, const Origin& origin, OpenMMInput& input) {
  for (int a = 0; a < force.getNumTorsions(); ++a) {
    PeriodicTorsion t{};
    force.getTorsionParameters(a, t.i, t.j, t.k, t.l, t.periodicity, t.phase, t.amplitude);
    origin.check({t.i, t.j, t.k, t.l}, "torsion", a);
    input.terms.torsions.push_back(t);
  }
}

void add(const OpenMM::RBTorsionForce& force, const Origin& origin, OpenMMInput& input) {
  for (int a = 0; a < force.getNumTorsions(); ++a) {
    RyckaertBellemans t{};
    auto& c = t.c;
    force.getTorsionParameters(a, t.i, t.j, t.k, t.l, c[0], c[1], c[2], c[3], c[4], c[5]);
    origin.check({t.i, t.j, t.k, t.l}, "torsion", a);
    input.terms.rb_torsions.push_back(t);
  }
}

void add(const OpenMM::CMMotionRemover& force, const Origin& origin, OpenMMInput& input) {
  if (input.remove_momentum_every != 0) origin.refuse("is the second, one is enough");
  input.remove_momentum_every = force.getFrequency();
}

void check_settings(const OpenMM::NonbondedForce& force, const Origin& origin, int atoms) {
  constexpr std::array kMethods = {"NoCutoff", "CutoffNonPeriodic", "CutoffPeriodic", "Ewald", "PME",
                                   "LJPME"};
  const int method = force.getNonbondedMethod();
  if (method > OpenMM::NonbondedForce::CutoffPeriodic)
    origin.refuse(fmt::format("uses {}: taut has NoCutoff, CutoffNonPeriodic and CutoffPeriodic",
                              kMethods.at(static_cast<std::size_t>(method))));
  if (force.getNumGlobalParameters() > 0 || force.getNumParticleParameterOffsets() > 0 ||
      force.getNumExceptionParameterOffsets() > 0)
    origin.refuse("has global parameters and offsets: taut has fixed parameters");
  if (!force.getIncludeDirectSpace()) origin.refuse("leaves its direct space out: taut does not");
  if (force.getNumParticles() != atoms)
    origin.refuse(fmt::format("has {} particles, the system has {} atoms", force.getNumParticles(), atoms));
}

void add(const OpenMM::NonbondedForce& force, const Origin& origin, OpenMMInput& input) {
  using Force = OpenMM::NonbondedForce;
  const int n = input.system.atoms();
  check_settings(force, origin, n);
  if (input.terms.nonbonded) origin.refuse("is the second: taut has one");

  Nonbonded& t = input.terms.nonbonded.emplace();
  t.charge.resize(n);
  t.sigma.resize(n);
  t.epsilon.resize(n);
  for (int a = 0; a < n; ++a) force.getParticleParameters(a, t.charge[a], t.sigma[a], t.epsilon[a]);

  t.exceptions.resize(force.getNumExceptions());
  for (int e = 0; e < force.getNumExceptions(); ++e) {
    auto& [i, j, charge_product, sigma, epsilon] = t.exceptions[e];
    force.getExceptionParameters(e, i, j, charge_product, sigma, epsilon);
    origin.check({i, j}, "exception", e);
  }

  // OpenMM ignores switch and dielectric without a cutoff, and the dispersion correction without a box.
  if (force.getNonbondedMethod() == Force::NoCutoff) return;
  t.cutoff = force.getCutoffDistance();
  t.rf_dielectric = force.getReactionFieldDielectric();
  if (force.getUseSwitchingFunction()) t.switch_distance = force.getSwitchingDistance();
  t.dispersion_correction =
      force.getNonbondedMethod() == Force::CutoffPeriodic && force.getUseDispersionCorrection();
}

template <class Force>
bool try_add(const OpenMM::Force& force, const Origin& origin, OpenMMInput& input) {
  const auto* known = dynamic_cast<const Force*>(&force);
  if (known != nullptr) add(*known, origin, input);
  return known != nullptr;
}

bool try_add_custom(const OpenMM::Force& force, const Origin& origin, OpenMMInput& input) {
  try {
    return read_custom_force(force, input.system, input.terms);
  } catch (const InputError& e) {
    origin.refuse(e.what());
  }
}

// Before OpenMM reads them: it may lack the plug-in of a force taut lacks.
void refuse_unknown_forces(const OpenMMFile& file) {
  for (int k = 0; k < static_cast<int>(file.forces.size()); ++k)
    if (std::find(kKnownForces.begin(), kKnownForces.end(), file.forces[k].type) == kKnownForces.end())
      Origin(file, k, 0)
          .refuse(fmt::format("is not one taut knows: it has {}", fmt::join(kKnownForces, ", ")));
}

void add_forces(const OpenMMFile& file, const OpenMM::System& system, OpenMMInput& input) {
  for (int k = 0; k < system.getNumForces(); ++k) {
    const OpenMM::Force& force = system.getForce(k);
    const Origin origin(file, k, system.getNumParticles());
    const bool added = try_add<OpenMM::HarmonicBondForce>(force, origin, input) ||
                       try_add<OpenMM::HarmonicAngleForce>(force, origin, input) ||
                       try_add<OpenMM::PeriodicTorsionForce>(force, origin, input) ||
                       try_add<OpenMM::RBTorsionForce>(force, origin, input) ||
                       try_add<OpenMM::NonbondedForce>(force, origin, input) ||
                       try_add<OpenMM::CMMotionRemover>(force, origin, input) ||
                       try_add_custom(force, origin, input);
    if (!added) origin.refuse("is not one taut knows");
  }
}

std::vector<RigidBond> constraints(const OpenMM::System& system) {
  std::vector<RigidBond> bonds(system.getNumConstraints());
  for (int k = 0; k < system.getNumConstraints(); ++k)
    system.getConstraintParameters(k, bonds[k].i, bonds[k].j, bonds[k].length);
  return bonds;
}

System masses_and_bonds(const OpenMMFile& file, const OpenMM::System& system) {
  Eigen::VectorXd mass(system.getNumParticles());
  for (int a = 0; a < system.getNumParticles(); ++a) {
    if (system.isVirtualSite(a)) file.refuse(fmt::format("atom {} is a virtual site: taut has none", a));
    mass[a] = system.getParticleMass(a);
  }
  const auto anchored = [&](int a) { return a >= 0 && a < mass.size() && mass[a] == 0; };
  std::vector<RigidBond> bonds = constraints(system);
  // Between two anchors there is nothing to hold: OpenMM, too, passes over such a constraint.
  const auto idle = [&](const RigidBond& b) { return b.i != b.j && anchored(b.i) && anchored(b.j); };
  bonds.erase(std::remove_if(bonds.begin(), bonds.end(), idle), bonds.end());
  try {
    return make_system(std::move(mass), std::move(bonds));
  } catch (const InputError& e) {
    file.refuse(fmt::format("among its constraints, {}", e.what()));
  }
}

// Whether any force is periodic. taut has one box, so a non-periodic NonbondedForce admits none.
bool is_periodic(const OpenMMFile& file, const OpenMM::System& system) {
  const bool any = system.usesPeriodicBoundaryConditions();
  for (int k = 0; any && k < system.getNumForces(); ++k) {
    const auto* force = dynamic_cast<const OpenMM::NonbondedForce*>(&system.getForce(k));
    if (force != nullptr && !force->usesPeriodicBoundaryConditions())
      Origin(file, k, 0).refuse("is not periodic but another force is: taut has one box for all");
  }
  return any;
}

// Whether OpenMM takes any term between nearest images.
bool takes_images(const OpenMM::System& system) {
  for (int k = 0; k < system.getNumForces(); ++k) {
    const OpenMM::Force& force = system.getForce(k);
    const auto* nonbonded = dynamic_cast<const OpenMM::NonbondedForce*>(&force);
    if (nonbonded != nullptr ? nonbonded->getExceptionsUsePeriodicBoundaryConditions()
                             : force.usesPeriodicBoundaryConditions())
      return true;
  }
  return false;
}

void check_images(const OpenMMFile& file, const Terms& terms, const std::vector<int>& molecule) {
  const auto check = [&](const char* kind, std::size_t k, std::initializer_list<int> atoms) {
    for (const int a : atoms)
      if (molecule[a] != molecule[*atoms.begin()])
        file.refuse(fmt::format("{} {} ({}) joins two molecules: taut takes no nearest image there", kind, k,
                                fmt::join(atoms, "-")));
  };
  std::size_t k = 0;
  for (const auto& t : terms.angles) check("angle", k++, {t.i, t.j, t.k});
  k = 0;
  for (const auto& t : terms.torsions) check("periodic torsion", k++, {t.i, t.j, t.k, t.l});
  k = 0;
  for (const auto& t : terms.rb_torsions) check("Ryckaert-Bellemans torsion", k++, {t.i, t.j, t.k, t.l});
  if (!terms.nonbonded) return;
  const auto& exceptions = terms.nonbonded->exceptions;
  for (k = 0; k < exceptions.size(); ++k)
    if (exceptions[k].charge_product != 0 || exceptions[k].epsilon != 0)
      check("exception", k, {exceptions[k].i, exceptions[k].j});
}

State start_of(const OpenMM::State& from, const System& sys) {
  State s;
  s.t = from.getTime();
  s.x = from_openmm(from.getPositions());
  s.v = Vectors::Zero(3, sys.atoms());
  if (from.getDataTypes() & OpenMM::State::Velocities) s.v = from_openmm(from.getVelocities());
  for (int a = 0; a < sys.atoms(); ++a)
    if (sys.mass[a] == 0) s.v.col(a).setZero();  // an anchor keeps its place, whatever its velocity says
  s.f = Vectors::Zero(3, sys.atoms());
  return s;
}

}  // namespace

OpenMMInput read_openmm(const std::filesystem::path& system_xml, const std::filesystem::path& state_xml) {
  const OpenMMFile system_file = open_openmm_file(system_xml, "System");
  const OpenMMFile state_file = open_openmm_file(state_xml, "State");
  refuse_unknown_forces(system_file);
  const auto system = read_system(system_file);
  const auto state = read_state(state_file, system->getNumParticles());

  OpenMMInput input;
  input.system = masses_and_bonds(system_file, *system);
  add_forces(system_file, *system, input);
  input.start = start_of(*state, input.system);
  if (!is_periodic(system_file, *system)) return input;

  input.system.box = read_box(state_file, *state);
  auto pairs = bonded_pairs(input.system, input.terms);
  for (const auto& b : constraints(*system)) pairs.push_back({b.i, b.j});  // those of anchors, too
  if (takes_images(*system)) check_images(system_file, input.terms, molecules(input.system.atoms(), pairs));
  try {
    make_whole(input.system.box, pairs, input.start.x);
  } catch (const InputError& e) {
    state_file.refuse(e.what());
  }
  return input;
}

}  // namespace taut
