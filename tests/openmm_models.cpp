#include "openmm_models.hpp"

#include <openmm/serialization/XmlSerializer.h>

#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <sstream>

#include "files/text_file.hpp"

namespace taut::tests {

namespace fs = std::filesystem;

namespace {

template <class T>
std::string xml(const T& object, const char* root) {
  std::ostringstream text;
  OpenMM::XmlSerializer::serialize(&object, root, text);
  return text.str();
}

template <class T>
std::unique_ptr<T> read_xml(const fs::path& file) {
  std::istringstream in(whole_text(file));
  return std::unique_ptr<T>(OpenMM::XmlSerializer::deserialize<T>(in));
}

}  // namespace

Melt::Melt(unsigned seed)
    : bonds(new OpenMM::HarmonicBondForce),
      angles(new OpenMM::HarmonicAngleForce),
      nonbonded(new OpenMM::NonbondedForce),
      random_(seed) {
  system.setDefaultPeriodicBoxVectors({kEdge, 0, 0}, {0, kEdge, 0}, {0, 0, kEdge});
  std::vector<std::pair<int, int>> pairs;
  for (int a = 0; a < kAtoms; ++a) {
    const int chain = a / kLength, bead = a % kLength;
    system.addParticle(uniform(1, 16));
    // Compilers differ in the order of arguments: numbers are drawn one by one.
    const double epsilon = uniform(0.1, 1), sigma = uniform(0.2, 0.3), charge = uniform(-0.5, 0.5);
    nonbonded->addParticle(charge, sigma, epsilon);
    const double dz = uniform(-0.05, 0.05), dy = uniform(-0.02, 0.02), dx = uniform(-0.02, 0.02);
    x.emplace_back(1.2 * (chain % 2) + 0.13 * bead + dx, 0.6 * (chain / 2 % 4) + 0.08 * (bead % 2) + dy,
                   0.6 * (chain / 8) + dz);
    const double vz = uniform(-0.5, 0.5), vy = uniform(-0.5, 0.5), vx = uniform(-0.5, 0.5);
    v.emplace_back(vx, vy, vz);
    if (bead > 0) pairs.emplace_back(a - 1, a);
    if (bead % 2 == 1) {
      const OpenMM::Vec3 d = x[a] - x[a - 1];
      system.addConstraint(a - 1, a, std::sqrt(d.dot(d)));
    } else if (bead > 0) {
      const double k = uniform(5e4, 2e5);
      bonds->addBond(a - 1, a, uniform(0.13, 0.17), k);
    }
    if (bead > 1) {
      const double k = uniform(200, 500);
      angles->addAngle(a - 2, a - 1, a, uniform(1.8, 2.1), k);
    }
  }
  nonbonded->createExceptionsFromBonds(pairs, 1 / 1.2, 0.5);
  system.addForce(bonds);
  system.addForce(angles);
  system.addForce(nonbonded);
}

template <class Use>
void Melt::each_torsion(Use use) {
  for (int a = 3; a < kAtoms; ++a)
    if (a % kLength >= 3) use(a - 3, a - 2, a - 1, a);
}

OpenMM::PeriodicTorsionForce* Melt::add_torsions() {
  auto* force = new OpenMM::PeriodicTorsionForce;
  each_torsion([&](int i, int j, int k, int l) {
    const double barrier = uniform(1, 20);
    force->addTorsion(i, j, k, l, 1 + l % 4, uniform(-3, 3), barrier);
  });
  system.addForce(force);
  return force;
}

OpenMM::RBTorsionForce* Melt::add_rb_torsions() {
  auto* force = new OpenMM::RBTorsionForce;
  each_torsion([&](int i, int j, int k, int l) {
    std::array<double, 6> c;
    for (double& each : c) each = uniform(-10, 10);
    force->addTorsion(i, j, k, l, c[5], c[4], c[3], c[2], c[1], c[0]);
  });
  system.addForce(force);
  return force;
}

void Melt::make_periodic() {
  nonbonded->setNonbondedMethod(OpenMM::NonbondedForce::CutoffPeriodic);
  nonbonded->setCutoffDistance(1.0);
}

void Melt::skew() {
  box.tilt = Vec3(-0.9, 0.7, -1.1);
  system.setDefaultPeriodicBoxVectors({kEdge, 0, 0}, {-0.9, kEdge, 0}, {0.7, -1.1, kEdge});
}

void Melt::break_across_box() {
  bonds->setUsesPeriodicBoundaryConditions(true);
  angles->setUsesPeriodicBoundaryConditions(true);
  nonbonded->setExceptionsUsePeriodicBoundaryConditions(true);
  const Vec3 corner(0.3, 0.04, 0);  // each of its three planes cuts chains
  for (auto& r : x) {
    const Vec3 steps = box.lattice_vector(box.cell_of(Vec3(r[0], r[1], r[2]) - corner, std::floor));
    r -= OpenMM::Vec3(steps[0], steps[1], steps[2]);
  }
}

fs::path Melt::write_system(const Folder& folder) const {
  return folder.write("melt.system.xml", xml(system, "System"));
}

Files Melt::write(const Folder& folder) const {
  OpenMM::VerletIntegrator none(0.001);
  OpenMM::Context context(system, none, OpenMM::Platform::getPlatformByName("Reference"));
  context.setPositions(x);
  context.setVelocities(v);
  for (const auto& [name, value] : parameters) context.setParameter(name, value);
  using S = OpenMM::State;
  const S state = context.getState(S::Positions | S::Velocities | S::Forces | S::Energy | S::Parameters);
  return {write_system(folder), folder.write("melt.state.xml", xml(state, "State"))};
}

Files without_settle(const Files& files, const Folder& folder) {
  const auto system = read_xml<OpenMM::System>(files.system);
  for (int k = 0; k < system->getNumConstraints(); ++k) {
    int i = 0, j = 0;
    double length = 0;
    system->getConstraintParameters(k, i, j, length);
    system->setConstraintParameters(k, i, j, length * (1 + 1e-6 * (k % 7)));
  }
  return {folder.write("system.xml", xml(*system, "System")), files.state};
}

Files all_bonds_rigid(const Files& files, const Folder& folder) {
  const auto system = read_xml<OpenMM::System>(files.system);
  const auto state = read_xml<OpenMM::State>(files.state);
  for (int f = system->getNumForces() - 1; f >= 0; --f) {
    const auto* springs = dynamic_cast<OpenMM::HarmonicBondForce*>(&system->getForce(f));
    if (!springs) continue;
    for (int k = 0; k < springs->getNumBonds(); ++k) {
      int i = 0, j = 0;
      double length = 0, stiffness = 0;
      springs->getBondParameters(k, i, j, length, stiffness);
      const OpenMM::Vec3 d = state->getPositions()[j] - state->getPositions()[i];
      system->addConstraint(i, j, std::sqrt(d.dot(d)));
    }
    system->removeForce(f);
  }
  return {folder.write("all_bonds.system.xml", xml(*system, "System")), files.state};
}

Files anchored_melt(const Folder& folder) {
  Melt melt(10);
  melt.make_periodic();
  for (const int a : {6, 13, 27}) melt.system.setParticleMass(a, 0);
  return melt.write(folder);
}

}  // namespace taut::tests

// OpenMM 7.7 does not free all tables it reads from XML.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:Discrete2DFunctionProxy\nleak:Continuous1DFunctionProxy";
}
