// What the importer makes of OpenMM's files, and what it refuses.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <sstream>

#include "base/errors.hpp"
#include "md/observables.hpp"
#include "openmm_models.hpp"
#include "systems/openmm/input.hpp"

namespace taut::openmm_import_tests {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using tests::Files;
using tests::Folder;
using tests::Melt;

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

// The message of the InputError that the import ends in.
std::string refusal(const std::filesystem::path& system, const std::filesystem::path& state) {
  try {
    read_openmm(system, state);
  } catch (const InputError& e) {
    return e.what();
  }
  return "nothing was refused";
}

// The same for a melt with something done to it.
std::string refusal_of(const std::function<void(Melt&)>& change) {
  Melt melt(1);
  const Folder folder;
  const Files files =
      melt.write(folder);  // OpenMM itself may refuse the changed one: the state is from before
  change(melt);
  return refusal(melt.write_system(folder), files.state);
}

// The same for a melt's files with something done to their text.
std::string refusal_of_text(const std::function<void(std::string& system, std::string& state)>& change) {
  Melt melt(1);
  const Folder folder;
  const Files good = melt.write(folder);
  std::string system = text_of(good.system), state = text_of(good.state);
  change(system, state);
  return refusal(folder.write("melt.system.xml", system), folder.write("melt.state.xml", state));
}

void replace(std::string& text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
}

template <class... Parts>
auto one_line_with(const Parts&... parts) {
  return AllOf(Not(HasSubstr("\n")), HasSubstr(parts)...);
}

TEST(OpenMMImport, ReadsWhatIsThere) {
  const Files files = tests::data("ala2-hbonds-rf");
  const OpenMMInput input = read_openmm(files.system, files.state);
  EXPECT_EQ(input.system.atoms(), input.start.x.cols());
  EXPECT_NEAR(input.start.box.edge.x(), 3.2852863, 1e-12);
  EXPECT_DOUBLE_EQ(input.start.x(2, 1), 1.5401023457131502);
  EXPECT_EQ(input.terms.angles.size(), 36u);
  ASSERT_TRUE(input.terms.nonbonded);
  EXPECT_EQ(input.terms.nonbonded->cutoff, 0.9);
  EXPECT_FALSE(input.terms.nonbonded->switch_distance);
  EXPECT_TRUE(input.terms.nonbonded->dispersion_correction);
  EXPECT_LT(bond_errors(input.system, input.start.x).max, 1e-4);
}

TEST(OpenMMImport, TakesMomentumRemovalAndAnchors) {
  Melt melt(1);
  melt.system.addForce(new OpenMM::CMMotionRemover(7));
  for (const int a : {0, 1, 6}) melt.system.setParticleMass(a, 0);  // 0-1 is a constraint
  const Folder folder;
  const Files files = melt.write(folder);
  const OpenMMInput input = read_openmm(files.system, files.state);
  EXPECT_EQ(input.remove_momentum_every, 7);
  EXPECT_EQ(input.system.inv_mass[6], 0);
  EXPECT_EQ(input.start.v.col(6).norm(), 0) << "an anchor that the file gives a velocity";
  EXPECT_GT(input.start.v.col(5).norm(), 0);
  EXPECT_EQ(input.system.bond_count(), melt.system.getNumConstraints() - 1)
      << "nothing to hold between anchors";
  EXPECT_FALSE(input.start.box.periodic()) << "nothing in it is periodic";
}

TEST(OpenMMImport, MakesMoleculesWhole) {
  Melt melt(1);
  melt.nonbonded->setNonbondedMethod(OpenMM::NonbondedForce::CutoffPeriodic);
  const auto whole = melt.x;
  melt.break_across_box();
  const Folder folder;
  const Files files = melt.write(folder);
  const OpenMMInput input = read_openmm(files.system, files.state);
  EXPECT_LT(bond_errors(input.system, input.start.x).max, 1e-12);
  int broken = 0;
  for (int a = 1; a < Melt::kAtoms; ++a) {
    if (a % Melt::kLength == 0) continue;
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(input.start.x(c, a) - input.start.x(c, a - 1), whole[a][c] - whole[a - 1][c], 1e-12);
      broken += std::abs(melt.x[a][c] - melt.x[a - 1][c]) > 1;
    }
  }
  EXPECT_GT(broken, 10);
}

TEST(OpenMMImport, TheStatesBoxWins) {
  Melt melt(1);
  melt.nonbonded->setNonbondedMethod(OpenMM::NonbondedForce::CutoffPeriodic);
  const Folder folder;
  const Files files = melt.write(folder);
  std::string state = text_of(files.state);
  replace(state, "<A x=\"2.4", "<A x=\"2.5");
  EXPECT_EQ(read_openmm(files.system, folder.write("s.xml", state)).start.box.edge, Vec3(2.5, 2.4, 2.4));
}

TEST(OpenMMImport, StandsStillWithoutVelocities) {
  Melt melt(1);
  const Folder folder;
  const Files files = melt.write(folder);
  std::string state = text_of(files.state);
  const auto from = state.find("<Velocities>"), to = state.find("</Velocities>") + 13;
  state.erase(from, to - from);
  EXPECT_EQ(read_openmm(files.system, folder.write("s.xml", state)).start.v.norm(), 0);
}

TEST(OpenMMImportRefuses, MethodsItLacks) {
  using Force = OpenMM::NonbondedForce;
  EXPECT_THAT(refusal_of([](Melt& melt) { melt.nonbonded->setNonbondedMethod(Force::LJPME); }),
              one_line_with("melt.system.xml:", "force 2: NonbondedForce: uses LJPME:", "CutoffPeriodic"));
}

// Exclusions take no nearest images; in PME they have a force.
TEST(OpenMMImportRefuses, PmeOfMoleculesBrokenAcrossTheBox) {
  using Force = OpenMM::NonbondedForce;
  const auto broken = [](Force::NonbondedMethod method) {
    Melt melt(1);
    melt.make_periodic();
    melt.break_across_box();
    melt.nonbonded->setExceptionsUsePeriodicBoundaryConditions(false);
    melt.nonbonded->setNonbondedMethod(method);
    int i, j;
    double charge, sigma, epsilon;
    for (int k = 0; k < melt.nonbonded->getNumExceptions(); ++k) {
      melt.nonbonded->getExceptionParameters(k, i, j, charge, sigma, epsilon);
      melt.nonbonded->setExceptionParameters(k, i, j, 0, 1, 0);
    }
    const Folder folder;
    const Files files = melt.write(folder);
    return refusal(files.system, files.state);
  };
  EXPECT_THAT(broken(Force::PME),
              one_line_with("force 2: NonbondedForce: exception", "is broken across the box"));
  EXPECT_EQ(broken(Force::CutoffPeriodic), "nothing was refused");
}

TEST(OpenMMImportRefuses, ForcesItLacks) {
  EXPECT_THAT(refusal_of([](Melt& m) { m.system.addForce(new OpenMM::GBSAOBCForce); }),
              one_line_with("melt.system.xml:", "force 3: GBSAOBCForce: is not one taut knows",
                            "HarmonicAngleForce"));
  EXPECT_THAT(refusal_of([](Melt& m) { m.system.addForce(new OpenMM::CustomBondForce("r^4")); }),
              one_line_with("melt.system.xml:", "force 3: CustomBondForce"));
  EXPECT_THAT(refusal_of_text([](std::string& s, auto&) {
                replace(s, "type=\"HarmonicAngleForce\"", "type=\"AmoebaVdwForce\"");
              }),
              one_line_with("melt.system.xml:", "force 1: AmoebaVdwForce"));
}

TEST(OpenMMImportRefuses, ASecondNonbondedForce) {
  EXPECT_THAT(refusal_of([](Melt& m) { m.system.addForce(new OpenMM::NonbondedForce(*m.nonbonded)); }),
              one_line_with("melt.system.xml:", "force 3: NonbondedForce: is the second"));
}

TEST(OpenMMImportRefuses, ParameterOffsets) {
  EXPECT_THAT(refusal_of([](Melt& m) { m.nonbonded->addGlobalParameter("lambda", 1); }),
              one_line_with("melt.system.xml:", "force 2", "global parameters"));
}

TEST(OpenMMImportRefuses, DirectSpaceLeftOut) {
  EXPECT_THAT(refusal_of([](Melt& m) { m.nonbonded->setIncludeDirectSpace(false); }),
              one_line_with("melt.system.xml:", "direct space"));
}

TEST(OpenMMImportRefuses, VirtualSitesInABond) {
  EXPECT_THAT(refusal_of([](Melt& m) {
                m.system.setParticleMass(2, 0);
                m.system.setVirtualSite(2, new OpenMM::TwoParticleAverageSite(3, 4, 0.5, 0.5));
              }),
              one_line_with("melt.system.xml:", "(2-3): atom 2 is a virtual site"));
}

TEST(OpenMMImportRefuses, BadConstraints) {
  EXPECT_THAT(refusal_of([](Melt& m) { m.system.addConstraint(1, 0, 0.15); }),
              one_line_with("melt.system.xml", "constraints", "(1-0)", "repeats"));
  EXPECT_THAT(refusal_of([](Melt& m) { m.system.addConstraint(0, 999, 0.15); }),
              one_line_with("melt.system.xml:", "Constraint has p2=\"999\"", "from 0 to 223"));
}

TEST(OpenMMImportRefuses, AtomsThatAreNotThere) {
  EXPECT_THAT(
      refusal_of([](Melt& m) { m.bonds->addBond(3, -1, 0.1, 1); }),
      one_line_with("melt.system.xml:", "force 0: HarmonicBondForce: Bond has p2=\"-1\"", "from 0 to 223"));
  EXPECT_THAT(refusal_of([](Melt& m) { m.add_rb_torsions()->addTorsion(0, 1, 2, 224, 1, 1, 1, 1, 1, 1); }),
              one_line_with("melt.system.xml:", "force 3: RBTorsionForce: Torsion has p4=\"224\""));
  EXPECT_THAT(refusal_of([](Melt& m) { m.system.addParticle(1); }),
              one_line_with("melt.state.xml", "224 positions", "225 atoms"));
}

TEST(OpenMMImportRefuses, BoxesNotReduced) {
  const auto tilt = [](std::string& system, std::string& state) {
    replace(system, "method=\"0\"", "method=\"2\"");
    replace(state, "<B x=\"0\"", "<B x=\"1.3\"");
  };
  EXPECT_THAT(refusal_of_text(tilt),
              one_line_with("melt.state.xml", "bx = 1.3 nm, expected at most half of ax"));
}

TEST(OpenMMImportRefuses, TwoMindsAboutTheBox) {
  EXPECT_THAT(refusal_of([](Melt& m) { m.angles->setUsesPeriodicBoundaryConditions(true); }),
              one_line_with(
                  "melt.system.xml:",
                  "force 2: NonbondedForce: its pairs are not periodic, but force 1: HarmonicAngleForce is"));
}

TEST(OpenMMImportRefuses, PeriodicTermsBetweenMolecules) {
  EXPECT_THAT(refusal_of([](Melt& m) {
                m.nonbonded->setNonbondedMethod(OpenMM::NonbondedForce::CutoffPeriodic);
                m.angles->setUsesPeriodicBoundaryConditions(true);
                m.angles->addAngle(0, 1, 7, 2, 100);
              }),
              one_line_with("melt.system.xml", "angle 160 (0-1-7) joins two molecules"));
}

TEST(OpenMMImportRefuses, MissingFiles) {
  EXPECT_THAT(refusal("nowhere/a.system.xml", "nowhere/a.state.xml"),
              one_line_with("nowhere/a.system.xml: cannot be read", "No such file"));
  EXPECT_THAT(refusal(std::filesystem::temp_directory_path(), "a"),
              one_line_with("cannot be read: is a folder"));
}

// OpenMM's own reader takes the first two for whole.
TEST(OpenMMImportRefuses, TruncatedFiles) {
  EXPECT_THAT(refusal_of_text([](auto&, std::string& state) { state.resize(state.find("</Forces>")); }),
              one_line_with("melt.state.xml:6", "not whole XML"));
  EXPECT_THAT(refusal_of_text([](auto&, std::string& state) { state.resize(state.find("</State>")); }),
              one_line_with("melt.state.xml:6", "not whole XML"));
  EXPECT_THAT(refusal_of_text([](std::string& system, auto&) { system.resize(system.size() / 2); }),
              one_line_with("melt.system.xml:", "not whole XML"));
  EXPECT_THAT(refusal_of_text([](std::string& system, auto&) { system.clear(); }),
              one_line_with("melt.system.xml:1: not whole XML"));
}

TEST(OpenMMImportRefuses, WhatIsNoXML) {
  EXPECT_THAT(refusal_of_text([](std::string& system, auto&) { system = "mass = 1\n"; }),
              one_line_with("melt.system.xml:1: not whole XML"));
  EXPECT_THAT(refusal_of_text([](std::string& system, auto&) { system = "<html/>"; }),
              one_line_with("melt.system.xml:1: expected an OpenMM System, found <html>"));
}

TEST(OpenMMImportRefuses, OneFileForTheOther) {
  EXPECT_THAT(refusal_of_text([](std::string& system, std::string& state) { system = state; }),
              one_line_with("melt.system.xml:2: expected an OpenMM System, found a \"State\""));
  EXPECT_THAT(refusal_of_text([](std::string& system, std::string& state) { state = system; }),
              one_line_with("melt.state.xml:2: expected an OpenMM State, found a \"System\""));
}

TEST(OpenMMImportRefuses, WordsForNumbers) {
  EXPECT_THAT(refusal_of_text([](std::string& system, auto&) { replace(system, "mass=\"", "mass=\"abc"); }),
              one_line_with("melt.system.xml:9: Particle has mass=\"abc", "expected a number"));
  EXPECT_THAT(refusal_of_text(
                  [](auto&, std::string& state) { replace(state, "<Position x=\"", "<Position x=\"nan"); }),
              one_line_with("melt.state.xml:", "Position has x=\"nan"));
}

TEST(OpenMMImportRefuses, AnAttributeLeftOut) {
  EXPECT_THAT(
      refusal_of_text([](std::string& system, auto&) { replace(system, "mass=\"15.957772123453983\"", ""); }),
      one_line_with("melt.system.xml:9: Particle lacks mass"));
}

TEST(OpenMMImportRefuses, AStateWithoutPositions) {
  EXPECT_THAT(refusal_of_text([](auto&, std::string& state) {
                const auto from = state.find("<Positions>"), to = state.find("</Positions>") + 12;
                state.erase(from, to - from);
              }),
              one_line_with("melt.state.xml", "no positions"));
}

}  // namespace
}  // namespace taut::openmm_import_tests
