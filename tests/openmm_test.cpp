// Energies and forces against OpenMM's Reference platform.

#include <gtest/gtest.h>
#include <openmm/serialization/XmlSerializer.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>

#include "base/errors.hpp"
#include "files/text_file.hpp"
#include "md/units.hpp"
#include "openmm_parity.hpp"

namespace taut::openmm_tests {
namespace {

using tests::data;
using tests::expect_agreement;
using tests::expect_parity;
using tests::Files;
using tests::Folder;
using tests::Melt;

class SharedSystem : public ::testing::TestWithParam<const char*> {};

TEST_P(SharedSystem, HasOpenMMsLivePotentialAndForces) {
  expect_parity(data(GetParam()));
}

TEST_P(SharedSystem, HasThePotentialAndForcesOfTheStateFile) {
  const Files files = data(GetParam());
  std::istringstream in(whole_text(files.state));
  const std::unique_ptr<OpenMM::State> state(OpenMM::XmlSerializer::deserialize<OpenMM::State>(in));
  OpenMMInput input = read_openmm(files.system, files.state);
  ForceField forces(input.system, input.start.box, input.terms);
  const double ours = forces.evaluate_energy(input.system, input.start);

  Vectors f(3, input.system.atoms());
  for (int a = 0; a < input.system.atoms(); ++a)
    for (int c = 0; c < 3; ++c) f(c, a) = state->getForces()[a][c];
  expect_agreement(ours, input.start.f, state->getPotentialEnergy(), f);
}

INSTANTIATE_TEST_SUITE_P(Data, SharedSystem,
                         ::testing::Values("tip3p-216", "ala2-hbonds-rf", "ala3-charmm36"),
                         [](const auto& name) {
                           std::string s = name.param;
                           std::replace(s.begin(), s.end(), '-', '_');
                           return s;
                         });

TEST(OpenMMParity, EveryPairWithoutCutoff) {
  Melt melt(1);
  melt.add_torsions();
  expect_parity(melt.write(Folder()));
}

TEST(OpenMMParity, RyckaertBellemansTorsions) {
  Melt melt(2);
  melt.add_rb_torsions();
  expect_parity(melt.write(Folder()));
}

TEST(OpenMMParity, CutoffWithoutBox) {
  Melt melt(3);
  melt.nonbonded->setNonbondedMethod(OpenMM::NonbondedForce::CutoffNonPeriodic);
  melt.nonbonded->setCutoffDistance(0.9);
  melt.nonbonded->setReactionFieldDielectric(5);
  expect_parity(melt.write(Folder()));
}

TEST(OpenMMParity, SwitchWithoutBox) {
  Melt melt(4);
  melt.nonbonded->setNonbondedMethod(OpenMM::NonbondedForce::CutoffNonPeriodic);
  melt.nonbonded->setCutoffDistance(1.0);
  melt.nonbonded->setUseSwitchingFunction(true);
  melt.nonbonded->setSwitchingDistance(0.5);
  expect_parity(melt.write(Folder()));
}

TEST(OpenMMParity, PeriodicWithAndWithoutDispersionCorrection) {
  for (const bool on : {false, true}) {
    Melt melt(5);
    melt.make_periodic();
    melt.nonbonded->setUseDispersionCorrection(on);
    expect_parity(melt.write(Folder()));
  }
}

// The correction's integral over the switched stretch included.
TEST(OpenMMParity, PeriodicSwitchWithAndWithoutDispersionCorrection) {
  for (const double from : {0.6, 0.8, 0.9})
    for (const bool on : {false, true}) {
      Melt melt(6);
      melt.make_periodic();
      melt.nonbonded->setUseDispersionCorrection(on);
      melt.nonbonded->setUseSwitchingFunction(true);
      melt.nonbonded->setSwitchingDistance(from);
      expect_parity(melt.write(Folder()));
    }
}

// As OpenMM would choose its parameters, and as they are given; charges that add to zero, and others:
// OpenMM 7.7 leaves out the background that they take, a constant.
TEST(OpenMMParity, ParticleMeshEwald) {
  for (const bool given : {false, true})
    for (const double surplus : {0.0, 3.0}) {
      Melt melt(8);
      melt.make_periodic();
      melt.nonbonded->setNonbondedMethod(OpenMM::NonbondedForce::PME);
      melt.nonbonded->setEwaldErrorTolerance(2e-4);
      if (given) melt.nonbonded->setPMEParameters(2.7, 8, 9, 10);
      double charge, sigma, epsilon, total = 0;
      for (int a = 0; a < Melt::kAtoms; ++a) {
        melt.nonbonded->getParticleParameters(a, charge, sigma, epsilon);
        total += charge;
      }
      for (int a = 0; a < Melt::kAtoms; ++a) {
        melt.nonbonded->getParticleParameters(a, charge, sigma, epsilon);
        melt.nonbonded->setParticleParameters(a, charge + (surplus - total) / Melt::kAtoms, sigma, epsilon);
      }
      const double alpha = given ? 2.7 : std::sqrt(-std::log(4e-4));
      expect_parity(melt.write(Folder()),
                    -kCoulomb * M_PI * surplus * surplus / (2 * std::pow(Melt::kEdge, 3) * alpha * alpha));
    }
}

TEST(OpenMMParity, SitesWithoutSizeOrCharge) {
  Melt melt(7);
  melt.make_periodic();
  for (int a = 0; a < Melt::kAtoms; a += 3) melt.nonbonded->setParticleParameters(a, 0.1, 0, 0);
  for (int a = 1; a < Melt::kAtoms; a += 3) melt.nonbonded->setParticleParameters(a, 0, 0.3, 0.5);
  expect_parity(melt.write(Folder()));
}

TEST(OpenMMParity, SeveralForcesOfAKind) {
  Melt melt(8);
  melt.make_periodic();
  melt.add_torsions();
  melt.add_torsions();
  melt.add_rb_torsions();
  melt.add_rb_torsions();
  auto* bonds = new OpenMM::HarmonicBondForce;
  auto* angles = new OpenMM::HarmonicAngleForce;
  for (int a = 0; a + 2 < Melt::kAtoms; a += Melt::kLength) {
    bonds->addBond(a, a + 2, 0.2, 1e4);
    angles->addAngle(a + 1, a, a + 2, 0.5, 100);
  }
  melt.system.addForce(bonds);
  melt.system.addForce(angles);
  expect_parity(melt.write(Folder()));
}

TEST(OpenMMParity, SkewedBoxes) {
  for (const auto method : {OpenMM::NonbondedForce::CutoffPeriodic, OpenMM::NonbondedForce::PME}) {
    Melt melt(8);
    melt.make_periodic();
    melt.skew();
    melt.nonbonded->setNonbondedMethod(method);
    melt.nonbonded->setPMEParameters(3.1, 20, 22, 25);
    double charge = 0, sigma = 0, epsilon = 0, total = 0;
    for (int a = 0; a < Melt::kAtoms; ++a) {
      melt.nonbonded->getParticleParameters(a, charge, sigma, epsilon);
      total += charge;
    }
    melt.nonbonded->setParticleParameters(Melt::kAtoms - 1, charge - total, sigma, epsilon);
    expect_parity(melt.write(Folder()));
  }
}

// Of seed 9 the Reference platform of OpenMM 7.7 misses a pair 0.904 nm apart, within the cutoff of 1 nm.
TEST(OpenMMParity, MoleculesBrokenAcrossASkewedBox) {
  Melt melt(8);
  melt.make_periodic();
  melt.skew();
  melt.add_torsions()->setUsesPeriodicBoundaryConditions(true);
  melt.break_across_box();
  expect_parity(melt.write(Folder()));
}

// OpenMM takes images term by term, taut mends the molecules: the forces are the same.
TEST(OpenMMParity, MoleculesBrokenAcrossTheBox) {
  Melt melt(9);
  melt.make_periodic();
  melt.add_torsions()->setUsesPeriodicBoundaryConditions(true);
  melt.add_rb_torsions()->setUsesPeriodicBoundaryConditions(true);
  melt.break_across_box();
  expect_parity(melt.write(Folder()));
}

// The State's velocities, time and parameters, as OpenMM itself takes them.
TEST(OpenMMTwinTest, StartsWhereTheStateIs) {
  Melt melt(15);
  const Folder folder;
  const Files files = melt.write(folder);
  const OpenMMInput input = read_openmm(files.system, files.state);
  const OpenMMTwin twin(files.system, files.state, {0.001});
  const State theirs = twin.state();
  EXPECT_EQ(theirs.t, input.start.t);
  EXPECT_EQ(theirs.x, input.start.x);
  EXPECT_EQ(theirs.v, input.start.v);
}

TEST(OpenMMTwinTest, RefusesAStateOfAnotherSystemInALine) {
  Melt melt(15);
  const Folder folder;
  const Files files = melt.write(folder);
  melt.system.addParticle(1);
  melt.nonbonded->addParticle(0, 0, 0);
  EXPECT_THROW(OpenMMTwin(melt.write_system(folder), files.state, {0.001}), InputError);
}

TEST(OpenMMTwinTest, GivesForcesAnywhere) {
  Melt melt(11);
  const Folder folder;
  const Files files = melt.write(folder);
  OpenMMTwin twin(files.system, files.state, {0.001});
  OpenMMInput input = read_openmm(files.system, files.state);
  input.start.x(1, 5) += 0.01;
  Vectors f;
  const double energy = twin.forces_at(input.start.x, f);
  ForceField forces(input.system, input.start.box, input.terms);
  const double ours = forces.evaluate_energy(input.system, input.start);
  expect_agreement(ours, input.start.f, energy, f);
}

TEST(OpenMMTwinTest, RunsOnThePlatformAskedFor) {
  const Files files = data("tip3p-216");
  const OpenMMTwin reference(files.system, files.state, {0.001});
  const OpenMMTwin cpu(files.system, files.state, {0.001, 1e-6, "CPU"});
  EXPECT_NEAR(cpu.potential(), reference.potential(), 1e-5 * std::abs(reference.potential()));
  EXPECT_THROW(OpenMMTwin(files.system, files.state, {0.001, 1e-6, "Abacus"}), InputError);
}

}  // namespace
}  // namespace taut::openmm_tests
