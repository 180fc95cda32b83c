#include "systems/openmm/openmm_export.hpp"

#include <OpenMM.h>
#include <fmt/format.h>
#include <openmm/serialization/XmlSerializer.h>

#include <sstream>

#include "files/atomic_file.hpp"
#include "md/errors.hpp"
#include "systems/openmm/openmm_expressions.hpp"
#include "systems/openmm/openmm_vectors.hpp"

namespace taut {
namespace {

void write_masses_and_bonds(const System& sys, OpenMM::System& to) {
  for (int a = 0; a < sys.atoms(); ++a) to.addParticle(sys.mass[a]);
  for (int k = 0; k < sys.bond_count(); ++k) {
    const auto& [i, j, length] = sys.bonds[k];
    if (sys.mass[i] == 0 || sys.mass[j] == 0)
      throw InputError(fmt::format(
          "OpenMM cannot express it: rigid bond {} ({}-{}) holds atom {}, which is an anchor, and "
          "OpenMM takes no constraint on an atom of mass 0",
          k, i, j, sys.mass[i] == 0 ? i : j));
    to.addConstraint(i, j, length);
  }
  const Vec3& edge = sys.box.edge;
  if (sys.box.periodic())
    to.setDefaultPeriodicBoxVectors({edge.x(), 0, 0}, {0, edge.y(), 0}, {0, 0, edge.z()});
}

void write_bonded(const Terms& terms, OpenMM::System& to) {
  if (!terms.bonds.empty()) {
    auto* force = new OpenMM::HarmonicBondForce;
    for (const auto& [i, j, length, k] : terms.bonds) force->addBond(i, j, length, k);
    to.addForce(force);
  }
  if (!terms.angles.empty()) {
    auto* force = new OpenMM::HarmonicAngleForce;
    for (const auto& [i, j, k, angle, stiffness] : terms.angles) force->addAngle(i, j, k, angle, stiffness);
    to.addForce(force);
  }
  if (!terms.torsions.empty()) {
    auto* force = new OpenMM::PeriodicTorsionForce;
    for (const auto& [i, j, k, l, periodicity, phase, amplitude] : terms.torsions)
      force->addTorsion(i, j, k, l, periodicity, phase, amplitude);
    to.addForce(force);
  }
  if (!terms.rb_torsions.empty()) {
    auto* force = new OpenMM::RBTorsionForce;
    for (const auto& [i, j, k, l, c] : terms.rb_torsions)
      force->addTorsion(i, j, k, l, c[0], c[1], c[2], c[3], c[4], c[5]);
    to.addForce(force);
  }
}

void write_nonbonded(const Nonbonded& from, const Box& box, OpenMM::System& to) {
  using Force = OpenMM::NonbondedForce;
  auto* force = new Force;
  for (Eigen::Index a = 0; a < from.charge.size(); ++a)
    force->addParticle(from.charge[a], from.sigma[a], from.epsilon[a]);
  for (const auto& [i, j, charge_product, sigma, epsilon] : from.exceptions)
    force->addException(i, j, charge_product, sigma, epsilon);
  force->setNonbondedMethod(!from.cutoff     ? Force::NoCutoff
                            : box.periodic() ? Force::CutoffPeriodic
                                             : Force::CutoffNonPeriodic);
  if (from.cutoff) force->setCutoffDistance(*from.cutoff);
  force->setReactionFieldDielectric(from.rf_dielectric);
  force->setUseSwitchingFunction(from.switch_distance.has_value());
  if (from.switch_distance) force->setSwitchingDistance(*from.switch_distance);
  force->setUseDispersionCorrection(from.dispersion_correction);
  to.addForce(force);
}

void write_gravity(const System& sys, const Vec3& g, OpenMM::System& to) {
  auto* force = new OpenMM::CustomExternalForce(kGravityEnergy);
  force->addPerParticleParameter("mass");
  force->addGlobalParameter("gx", g.x());
  force->addGlobalParameter("gy", g.y());
  force->addGlobalParameter("gz", g.z());
  for (int a = 0; a < sys.atoms(); ++a)
    if (sys.mass[a] > 0) force->addParticle(a, {sys.mass[a]});
  to.addForce(force);
}

void write_pulls(const std::vector<Pull>& pulls, OpenMM::System& to) {
  auto* force = new OpenMM::CustomExternalForce(kPullEnergy);
  for (const char* name : {"fx", "fy", "fz"}) force->addPerParticleParameter(name);
  for (const auto& [atom, f] : pulls) force->addParticle(atom, {f.x(), f.y(), f.z()});
  to.addForce(force);
}

void write_fene(const std::vector<Fene>& springs, OpenMM::System& to) {
  auto* force = new OpenMM::CustomBondForce(kFeneEnergy);
  for (const char* name : {"k", "r0"}) force->addPerBondParameter(name);
  for (const auto& [i, j, k, r0] : springs) force->addBond(i, j, {k, r0});
  to.addForce(force);
}

void write_wca(const System& sys, const Wca& wca, OpenMM::System& to) {
  using Force = OpenMM::CustomNonbondedForce;
  auto* force = new Force(kWcaEnergy);
  force->addGlobalParameter("sigma", wca.sigma);
  force->addGlobalParameter("epsilon", wca.epsilon);
  for (int a = 0; a < sys.atoms(); ++a) force->addParticle();
  for (const auto& [i, j] : wca.exclusions) force->addExclusion(i, j);
  force->setNonbondedMethod(sys.box.periodic() ? Force::CutoffPeriodic : Force::CutoffNonPeriodic);
  force->setCutoffDistance(wca.reach());
  to.addForce(force);
}

std::unique_ptr<OpenMM::State> make_openmm_state(const OpenMMInput& from) {
  OpenMM::State::StateBuilder state(from.start.t, 0);
  state.setPositions(to_openmm(from.start.x));
  state.setVelocities(to_openmm(from.start.v));
  const Vec3 edge =
      from.system.box.periodic() ? from.system.box.edge : Vec3(1, 1, 1);  // then it means nothing
  state.setPeriodicBoxVectors({edge.x(), 0, 0}, {0, edge.y(), 0}, {0, 0, edge.z()});
  return std::make_unique<OpenMM::State>(state.getState());
}

template <class T>
std::string xml(const T& object, const char* root) {
  std::ostringstream text;
  OpenMM::XmlSerializer::serialize(&object, root, text);
  return text.str();
}

}  // namespace

std::unique_ptr<OpenMM::System> make_openmm_system(const OpenMMInput& from) {
  auto system = std::make_unique<OpenMM::System>();
  write_masses_and_bonds(from.system, *system);
  write_bonded(from.terms, *system);
  if (from.terms.nonbonded) write_nonbonded(*from.terms.nonbonded, from.system.box, *system);
  if (from.terms.gravity) write_gravity(from.system, *from.terms.gravity, *system);
  if (!from.terms.pulls.empty()) write_pulls(from.terms.pulls, *system);
  if (!from.terms.fene.empty()) write_fene(from.terms.fene, *system);
  if (from.terms.wca) write_wca(from.system, *from.terms.wca, *system);
  if (from.remove_momentum_every > 0)
    system->addForce(new OpenMM::CMMotionRemover(static_cast<int>(from.remove_momentum_every)));
  return system;
}

void write_openmm(const OpenMMInput& from, const std::string& prefix) {
  AtomicFile system(prefix + ".system.xml"), state(prefix + ".state.xml");
  system.write(xml(*make_openmm_system(from), "System"));
  state.write(xml(*make_openmm_state(from), "State"));
  system.commit();
  state.commit();
}

}  // namespace taut
