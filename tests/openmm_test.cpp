// Energies and forces against OpenMM's Reference platform.

#include <gtest/gtest.h>
#include <openmm/serialization/XmlSerializer.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>

#include "forcefield/force_field.hpp"
#include "md/errors.hpp"
#include "md/units.hpp"
#include "openmm_models.hpp"
#include "studies/openmm_twin.hpp"
#include "systems/openmm/openmm_read.hpp"

namespace taut {
namespace {

using testing::data;
using testing::Files;
using testing::Folder;
using testing::Melt;

double rms(const Vectors& f) {
  return std::sqrt(f.squaredNorm() / static_cast<double>(f.size()));
}

// Energy to 1e-9, every force component to 1e-7 of their rms.
void expect_agreement(double energy, const Vectors& f, double their_energy, const Vectors& their_f) {
  EXPECT_NEAR(energy, their_energy, 1e-9 * std::abs(their_energy));
  ASSERT_EQ(f.cols(), their_f.cols());
  EXPECT_LT((f - their_f).cwiseAbs().maxCoeff(), 1e-7 * rms(their_f));
}

// taut's potential and forces against those of the twin, live. `more`: what taut's potential has and OpenMM's
// not.
void expect_parity(const Files& files, double more = 0) {
  OpenMMInput input = read_openmm(files.system, files.state);
  ForceField forces(input.system, input.start.box, input.terms);
  forces(input.system, input.start);
  const OpenMMTwin twin(files.system, files.state, {0.001});
  expect_agreement(forces.potential(), input.start.f, twin.potential() + more, twin.state().f);
}

class SharedSystem : public ::testing::TestWithParam<const char*> {};

TEST_P(SharedSystem, HasOpenMMsLivePotentialAndForces) {
  expect_parity(data(GetParam()));
}

TEST_P(SharedSystem, HasThePotentialAndForcesOfTheStateFile) {
  const Files files = data(GetParam());
  std::ifstream in(files.state);
  const std::unique_ptr<OpenMM::State> state(OpenMM::XmlSerializer::deserialize<OpenMM::State>(in));
  OpenMMInput input = read_openmm(files.system, files.state);
  ForceField forces(input.system, input.start.box, input.terms);
  forces(input.system, input.start);

  Vectors f(3, input.system.atoms());
  for (int a = 0; a < input.system.atoms(); ++a)
    for (int c = 0; c < 3; ++c) f(c, a) = state->getForces()[a][c];
  expect_agreement(forces.potential(), input.start.f, state->getPotentialEnergy(), f);
}

INSTANTIATE_TEST_SUITE_P(Data, SharedSystem,
                         ::testing::Values("tip3p-216", "tip3p-1000", "ala2-hbonds-rf", "ala2-allbonds-rf"),
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

// OpenMM takes images term by term, taut mends the molecules: the forces are the same.
TEST(OpenMMParity, MoleculesBrokenAcrossTheBox) {
  Melt melt(9);
  melt.make_periodic();
  melt.add_torsions()->setUsesPeriodicBoundaryConditions(true);
  melt.add_rb_torsions()->setUsesPeriodicBoundaryConditions(true);
  melt.break_across_box();
  expect_parity(melt.write(Folder()));
}

// The custom forces taut knows, their parameters declared in every order, of each term (true) or of all.
using Declared = std::vector<std::pair<std::string, bool>>;
const auto kEither = [](const auto& a, const auto& b) {
  return std::vector<Declared>{{{a, true}, {b, true}},
                               {{b, true}, {a, true}},
                               {{a, true}, {b, false}},
                               {{a, false}, {b, true}},
                               {{b, false}, {a, false}}};
};

TEST(OpenMMParity, FeneHoweverItIsDeclared) {
  for (const Declared& declared : kEither("k", "r0"))
    for (const bool changed : {false, true}) {
      Melt melt(12);
      auto* force = new OpenMM::CustomBondForce("-0.5*k*r0^2*log(1-(r/r0)^2)");
      for (const auto& [name, each] : declared)
        if (each)
          force->addPerBondParameter(name);
        else
          force->addGlobalParameter(name, name == "k" ? 900 : 0.6);
      for (int a = 0; a + 1 < Melt::kAtoms; a += Melt::kLength) {
        std::vector<double> of_bond;
        for (const auto& [name, each] : declared)
          if (each) of_bond.push_back(name == "k" ? melt.uniform(500, 2000) : melt.uniform(0.4, 0.8));
        force->addBond(a, a + 1, of_bond);
      }
      melt.system.addForce(force);
      if (changed)
        for (const auto& [name, each] : declared)
          if (!each) melt.parameters[name] = name == "k" ? 1200 : 0.5;
      expect_parity(melt.write(Folder()));
    }
}

TEST(OpenMMParity, GravityAndPullsHoweverTheyAreDeclared) {
  std::vector<std::string> axes = {"x", "y", "z"};
  do {
    Melt melt(13);
    auto* gravity = new OpenMM::CustomExternalForce("-mass*(gx*x+gy*y+gz*z)");
    auto* pull = new OpenMM::CustomExternalForce("-(fx*x+fy*y+fz*z)");
    gravity->addPerParticleParameter("mass");
    for (const auto& c : axes) {
      gravity->addGlobalParameter("g" + c, melt.uniform(-10, 10));
      if (c == "y")
        pull->addGlobalParameter("fy", 7);
      else
        pull->addPerParticleParameter("f" + c);
    }
    for (int a = Melt::kAtoms - 1; a >= 0; --a) gravity->addParticle(a, {melt.system.getParticleMass(a)});
    for (const int a : {5, 3, 200, 5}) pull->addParticle(a, {melt.uniform(-9, 9), melt.uniform(-9, 9)});
    melt.system.addForce(gravity);
    melt.system.addForce(pull);
    melt.parameters = {{"gy", 3.5}, {"fy", -2}};
    expect_parity(melt.write(Folder()));
  } while (std::next_permutation(axes.begin(), axes.end()));
}

TEST(OpenMMParity, RepulsiveBeadsHoweverTheyAreDeclared) {
  for (const bool periodic : {false, true})
    for (const char* first : {"sigma", "epsilon"}) {
      Melt melt(14);
      if (periodic) melt.make_periodic();
      auto* beads = new OpenMM::CustomNonbondedForce("4*epsilon*((sigma/r)^12-(sigma/r)^6)+epsilon");
      for (const char* name : {first, *first == 's' ? "epsilon" : "sigma"})
        beads->addGlobalParameter(name, *name == 's' ? 0.31 : 0.9);
      for (int a = 0; a < Melt::kAtoms; ++a) beads->addParticle();
      for (int a = 1; a < Melt::kAtoms; ++a)
        if (a % Melt::kLength != 0) beads->addExclusion(a, a - 1);
      beads->setNonbondedMethod(periodic ? OpenMM::CustomNonbondedForce::CutoffPeriodic
                                         : OpenMM::CustomNonbondedForce::CutoffNonPeriodic);
      beads->setCutoffDistance(std::pow(2.0, 1.0 / 6) * 0.3);
      melt.system.addForce(beads);
      melt.parameters = {{"sigma", 0.3}};
      expect_parity(melt.write(Folder()));
    }
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
  forces(input.system, input.start);
  expect_agreement(forces.potential(), input.start.f, energy, f);
}

TEST(OpenMMTwinTest, RunsOnThePlatformAskedFor) {
  const Files files = data("tip3p-216");
  const OpenMMTwin reference(files.system, files.state, {0.001});
  const OpenMMTwin cpu(files.system, files.state, {0.001, 1e-6, "CPU"});
  EXPECT_NEAR(cpu.potential(), reference.potential(), 1e-5 * std::abs(reference.potential()));
  EXPECT_THROW(OpenMMTwin(files.system, files.state, {0.001, 1e-6, "Abacus"}), InputError);
}

}  // namespace
}  // namespace taut
