// Molecules that OpenMM has bonded around the box to their own image, against its Reference platform.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openmm/serialization/XmlSerializer.h>

#include <cmath>
#include <memory>
#include <sstream>

#include "error_message.hpp"
#include "openmm_models.hpp"
#include "openmm_parity.hpp"

namespace taut::openmm_networks_tests {
namespace {

using testing::HasSubstr;
using tests::Files;
using tests::Folder;

template <class Part>
std::string xml(const Part& part, const char* type) {
  std::ostringstream text;
  OpenMM::XmlSerializer::serialize(&part, type, text);
  return text.str();
}

// Three strands of ten atoms, each around the edge of its own, in springs of bonds and angles, torsions and exceptions.
struct Strands {
  OpenMM::System system;
  std::vector<OpenMM::Vec3> x;
  OpenMM::HarmonicBondForce* bonds = new OpenMM::HarmonicBondForce;
  OpenMM::NonbondedForce* nonbonded = new OpenMM::NonbondedForce;

  Strands() {
    constexpr int n = 10;
    constexpr double edge = 2;
    system.setDefaultPeriodicBoxVectors({edge, 0, 0}, {0, edge, 0}, {0, 0, edge});
    auto* angles = new OpenMM::HarmonicAngleForce;
    auto* torsions = new OpenMM::PeriodicTorsionForce;
    for (int axis = 0; axis < 3; ++axis)
      for (int k = 0; k < n; ++k) {
        const int first = n * axis, a = first + k, b = first + (k + 1) % n, c = first + (k + 2) % n,
                  d = first + (k + 3) % n;
        OpenMM::Vec3 at(0.3 + 0.55 * axis, 0.2 + 0.5 * axis, 0.9 - 0.3 * axis);
        at[axis] = edge * (k + 0.2 * std::sin(k)) / n;
        at[(axis + 1) % 3] += 0.08 * std::cos(1.3 * k);
        at[(axis + 2) % 3] += 0.07 * std::sin(2.1 * k);
        x.push_back(at);
        system.addParticle(10 + k);
        bonds->addBond(a, b, 0.23, 20000);
        angles->addAngle(a, b, c, 2.5, 100);
        torsions->addTorsion(a, b, c, d, 2, 0.4, 3);
        nonbonded->addParticle(k % 2 == 0 ? 0.3 : -0.3, 0.25, 0.5);
        nonbonded->addException(a, b, 0, 1, 0);
        nonbonded->addException(a, c, 0, 1, 0);
        nonbonded->addException(a, d, -0.06, 0.24, 0.2);
      }
    nonbonded->setNonbondedMethod(OpenMM::NonbondedForce::PME);
    nonbonded->setPMEParameters(4, 24, 24, 24);
    nonbonded->setCutoffDistance(0.8);
    nonbonded->setExceptionsUsePeriodicBoundaryConditions(true);
    bonds->setUsesPeriodicBoundaryConditions(true);
    angles->setUsesPeriodicBoundaryConditions(true);
    torsions->setUsesPeriodicBoundaryConditions(true);
    for (OpenMM::Force* force :
         {static_cast<OpenMM::Force*>(bonds), static_cast<OpenMM::Force*>(angles),
          static_cast<OpenMM::Force*>(torsions), static_cast<OpenMM::Force*>(nonbonded)})
      system.addForce(force);
  }

  Files write(const Folder& folder) const {
    OpenMM::VerletIntegrator none(0.001);
    OpenMM::Context context(system, none, OpenMM::Platform::getPlatformByName("Reference"));
    context.setPositions(x);
    const OpenMM::State state = context.getState(OpenMM::State::Positions | OpenMM::State::Velocities);
    return {folder.write("a.system.xml", xml(system, "System")),
            folder.write("a.state.xml", xml(state, "State"))};
  }
};

TEST(OpenMMNetworks, HaveItsPotentialAndForces) {
  const Folder folder;
  tests::expect_parity(Strands().write(folder));
  Strands wrapped;
  wrapped.x[4][0] += 2;
  wrapped.x[17][2] -= 4;
  tests::expect_parity(wrapped.write(folder));
}

TEST(OpenMMNetworks, AreRefusedWhereAForceTakesNoImages) {
  const Folder folder;
  Strands strands;
  strands.bonds->setUsesPeriodicBoundaryConditions(false);
  const Files files = strands.write(folder);
  EXPECT_THAT(
      error_message([&] { read_openmm(files.system, files.state); }),
      HasSubstr(
          "force 0: HarmonicBondForce: bond 9 (9-0) goes through the box, as its molecule is bonded to its "
          "own image, and usesPeriodic is 0"));
}

}  // namespace
}  // namespace taut::openmm_networks_tests
