// What the importer makes of OpenMM's files, and what it refuses.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <sstream>

#include "base/errors.hpp"
#include "error_message.hpp"
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
  return error_message([&] { read_openmm(system, state); });
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
  EXPECT_EQ(broken(Force::CutoffPeriodic), "no error");
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
}

TEST(OpenMMImportRefuses, MissingFiles) {
  EXPECT_THAT(refusal("nowhere/a.system.xml", "nowhere/a.state.xml"),
              one_line_with("nowhere/a.system.xml: cannot be read", "No such file"));
  EXPECT_THAT(refusal(std::filesystem::temp_directory_path(), "a"),
              one_line_with("cannot be read: is a folder"));
}

}  // namespace
}  // namespace taut::openmm_import_tests
