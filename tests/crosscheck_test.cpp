// Everything taut can hand to OpenMM, held against it at a short length.

#include "studies/crosscheck.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "forcefield/force_field.hpp"
#include "md/errors.hpp"
#include "openmm_folder.hpp"
#include "studies/crosscheck_verdict.hpp"
#include "studies/openmm_twin.hpp"
#include "systems/openmm/openmm_export.hpp"
#include "systems/openmm/openmm_import.hpp"
#include "systems/scene_file.hpp"

namespace taut {
namespace {

using ::testing::AllOf;
using testing::data;
using testing::Files;
using testing::Folder;
using ::testing::HasSubstr;
using ::testing::Not;

Crosscheck held_against_openmm(Scene scene, CrosscheckPlan plan, long steps, long parting) {
  scene.run.steps = steps;
  plan.contestants = contestants({"newton", "rattle"});
  plan.parting_steps = parting;
  plan.samples = 5;
  plan.speed_seconds = 0;
  return crosscheck(scene, plan);
}

// Start, leap-frog, bonds, newton and rattle, all.
void expect_agreement(const Crosscheck& c) {
  for (const Verdict& v : verdicts(c)) EXPECT_EQ(v.finding, Finding::kAgrees) << v.who << ": " << v.why;
}

struct Given {
  const char* name;
  long steps, parting;
  bool as_given = true;  // agrees with the lengths as given
};
class CrosscheckOfFiles : public ::testing::TestWithParam<Given> {};

TEST_P(CrosscheckOfFiles, NewtonAndRattleFollowTheTwin) {
  const auto& [name, steps, parting, as_given] = GetParam();
  const Files files = data(name);
  CrosscheckPlan plan;
  plan.files = OpenMMFiles{files.system, files.state};
  const Crosscheck c = held_against_openmm(import_openmm(files.system, files.state), plan, steps, parting);
  for (const Track& track : c.tracks) EXPECT_EQ(track.samples.back().step, steps);
  if (as_given) expect_agreement(c);
  // All that parts them is that OpenMM holds waters at lengths rounded to float: with those, newton follows
  // it.
  EXPECT_GT(c.openmm_bonds.rounded, 0);
  EXPECT_GT(*c.openmm_bonds.apart_as_given, 1e-10);
  EXPECT_LT(*c.openmm_bonds.apart_as_given, 1e-5);
  EXPECT_LT(*c.openmm_bonds.apart_with_theirs, 1e-12);
}

// In ala2-hbonds-rf atoms 83 and 260 cross the cutoff at step 7, within 4e-9 nm of it: which side of the step
// they are on hangs on that rounding, the reaction field's force is not zero there, and the kick tears the
// runs 3e-6 nm apart.
INSTANTIATE_TEST_SUITE_P(Data, CrosscheckOfFiles,
                         ::testing::Values(Given{"tip3p-216", 200, 5}, Given{"tip3p-1000", 10, 5},
                                           Given{"ala2-hbonds-rf", 14, 14, false},
                                           Given{"ala2-allbonds-rf", 20, 5}),
                         [](const auto& given) {
                           std::string s = given.param.name;
                           std::replace(s.begin(), s.end(), '-', '_');
                           return s;
                         });

bool expressible(const Scene& scene) {
  for (const auto& [i, j, d] : scene.system.bonds)
    if (scene.system.mass[i] == 0 || scene.system.mass[j] == 0) return false;
  return true;
}

TEST(Crosscheck, EveryExpressibleSceneAgrees) {
  int held = 0;
  for (const auto& [name, hard_on] : list_scenes()) {
    SCOPED_TRACE(name);
    const Scene scene = read_scene(find_scene(name));
    if (!expressible(scene)) continue;
    ++held;
    expect_agreement(held_against_openmm(scene, {}, 6, 3));
  }
  EXPECT_GE(held, 11);
}

TEST(Crosscheck, SaysWhatOpenMMCannotExpress) {
  for (const char* name : {"pendulum", "double_pendulum"}) try {
      crosscheck(read_scene(find_scene(name)), {});
      FAIL() << name;
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(),
                  AllOf(HasSubstr("OpenMM cannot express it"), HasSubstr("anchor"), Not(HasSubstr("\n"))));
    }
}

// What the closed form of its residual foretells, to within what it leaves out, the next order in h: its bond
// errors to 1 %, and its departure to 5 %.
void expect_foretold(Scene scene, long steps) {
  scene.run.steps = steps;
  CrosscheckPlan plan;
  plan.contestants = contestants({"baumgarte"});
  for (const char* damping : {"implicit", "lagged"})
    plan.contestants.push_back({damping, Baumgarte::Options{.damping = damping}});
  plan.contestants.push_back({"two passes", Baumgarte::Options{.gains = "critical", .passes = 2}});
  plan.parting_steps = steps;
  plan.samples = 5;
  plan.speed_seconds = 0;
  const Crosscheck c = crosscheck(scene, plan);
  for (const Track& track : c.tracks) {
    SCOPED_TRACE(track.name);
    ASSERT_TRUE(track.foretold);
    const auto& [judged, bond_rms, apart] = *track.foretold;
    EXPECT_EQ(judged, steps);
    EXPECT_GT(apart, 1e-7) << "there is something to foretell";
    EXPECT_NEAR(bond_rms / track.rms_bond(steps), 1, 0.01);
    // Gains that differ from bond to bond of a water (physical) are foretold 1.6 times too far: why is not
    // known.
    const bool mixed = track.name == "baumgarte physical" && scene.name == "water";
    EXPECT_NEAR(apart / track.apart_at(steps), mixed ? 1.6 : 1, 0.05);
  }
}

TEST(Crosscheck, BaumgarteDepartsFromRattleAsItsResidualForetells) {
  expect_foretold(read_scene(find_scene("water"), {"run.dt_fs=1"}), 30);
  expect_foretold(read_scene(find_scene("freely_jointed"), {"build.chains=10"}), 50);
}

TEST(Crosscheck, LeapfrogTakesTheSamePositions) {
  Scene scene = read_scene(find_scene("freely_jointed"), {"build.chains=10", "run.steps=20"});
  CrosscheckPlan plan;
  plan.speed_seconds = 0;
  const Crosscheck c = crosscheck(scene, plan);
  EXPECT_LT(c.leapfrog.positions, 1e-10);
  EXPECT_LT(c.leapfrog.velocities, 1e-7);
  EXPECT_GT(c.leapfrog.velocities_kept, 1e-3) << "half a step behind";
}

TEST(Contestants, ByName) {
  EXPECT_EQ(contestants({"baumgarte"}).size(), 6u);
  EXPECT_EQ(contestants({"baumgarte:critical"})[0].name, "baumgarte critical");
  EXPECT_THROW(contestants({"baumgarte:sideways"}), InputError);
  EXPECT_THROW(contestants({"ratle"}), InputError);
  EXPECT_THROW(contestants({"rattle:critical"}), InputError);
}

// Beads with everything OpenMM has no class for.
OpenMMInput custom_terms(bool periodic) {
  OpenMMInput input;
  const double edge = 4;
  input.system = make_system((Eigen::VectorXd(6) << 1, 2, 3, 0, 5, 6).finished(), {{0, 1, 0.9}},
                             periodic ? Box{{edge, edge, edge}} : Box{});
  input.terms.gravity = Vec3(1, -9.81, 2);
  input.terms.pulls = {{2, Vec3(3, -4, 5)}, {5, Vec3(0, 1, 0)}};
  input.terms.fene = {{1, 2, 30, 1.5}, {4, 5, 20, 1.6}};
  input.terms.wca = Wca{1.0, 1.5, {{0, 1}, {1, 2}}};
  input.start.x.resize(3, 6);
  input.start.x << 0, 0.9, 1.7, 0.3, 1.1, 2.0,  //
      0, 0, 0.4, 0.9, 0.8, 0.7,                 //
      0, 0, 0.1, 0.2, 0.3, 0.9;
  input.start.v = Vectors::Constant(3, 6, 0.1);
  input.start.v.col(3).setZero();
  input.start.f = Vectors::Zero(3, 6);
  return input;
}

TEST(OpenMMExport, CustomForcesAreThoseOfTaut) {
  for (const bool periodic : {false, true}) {
    OpenMMInput input = custom_terms(periodic);
    OpenMMTwin twin(input, {.h = 0.001});
    ForceField forces(input.system, input.terms);
    forces(input.system, input.start);
    Vectors theirs;
    const double energy = twin.forces_at(input.start.x, theirs);
    theirs.col(3) = input.start.f.col(3);  // the anchor, which no force moves
    EXPECT_NEAR(forces.potential(), energy, 1e-9 * std::abs(energy));
    EXPECT_LT((input.start.f - theirs).cwiseAbs().maxCoeff(), 1e-9 * theirs.norm());
  }
}

TEST(OpenMMExport, IsReadBackAsItWas) {
  const Folder folder;
  const std::filesystem::path any = folder.write("x", "");
  const std::string prefix = (any.parent_path() / "beads").string();
  OpenMMInput input = custom_terms(true);
  input.remove_momentum_every = 7;
  write_openmm(input, prefix);
  const OpenMMInput back = read_openmm(prefix + ".system.xml", prefix + ".state.xml");
  EXPECT_EQ(back.system.mass, input.system.mass);
  EXPECT_EQ(back.system.bond_count(), 1);
  EXPECT_EQ(back.system.box.edge, input.system.box.edge);
  EXPECT_EQ(back.start.x, input.start.x);
  EXPECT_EQ(back.start.v, input.start.v);
  EXPECT_EQ(back.remove_momentum_every, 7);
  EXPECT_EQ(back.terms.gravity, input.terms.gravity);
  ASSERT_EQ(back.terms.pulls.size(), 2u);
  EXPECT_EQ(back.terms.pulls[0].force, input.terms.pulls[0].force);
  ASSERT_EQ(back.terms.fene.size(), 2u);
  EXPECT_EQ(back.terms.fene[1].r0, 1.6);
  ASSERT_TRUE(back.terms.wca);
  EXPECT_EQ(back.terms.wca->sigma, 1.0);
  EXPECT_EQ(back.terms.wca->epsilon, 1.5);
  EXPECT_EQ(back.terms.wca->exclusions, input.terms.wca->exclusions);
}

TEST(OpenMMExport, EverySceneComesBackWithItsForces) {
  const Folder folder;
  const std::filesystem::path any = folder.write("x", "");
  for (const char* name : {"decane", "melt", "pair", "water_cluster"}) {
    SCOPED_TRACE(name);
    Scene scene = read_scene(find_scene(name));
    const std::string prefix = (any.parent_path() / name).string();
    write_openmm(openmm_input(scene), prefix);
    Scene back = import_openmm(prefix + ".system.xml", prefix + ".state.xml");
    ForceField ours(scene.system, scene.terms), theirs(back.system, back.terms);
    ours(scene.system, scene.start);
    theirs(back.system, back.start);
    EXPECT_NEAR(ours.potential(), theirs.potential(), 1e-9 * std::abs(ours.potential()));
    EXPECT_LT((scene.start.f - back.start.f).norm(), 1e-9 * scene.start.f.norm());
  }
}

TEST(OpenMMExport, ForeignExpressionsAreRefused) {
  const Folder folder;
  const std::filesystem::path any = folder.write("x", "");
  const std::string prefix = (any.parent_path() / "beads").string();
  write_openmm(custom_terms(false), prefix);
  std::ostringstream text;
  text << std::ifstream(prefix + ".system.xml").rdbuf();
  for (const auto& [from, to] :
       {std::pair("-0.5*k", "-0.6*k"), {"-mass*(gx", "-mass*(2*gx"}, {"4*epsilon", "3*epsilon"}}) {
    std::string changed = text.str();
    const auto at = changed.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    changed.replace(at, std::string(from).size(), to);
    try {
      read_openmm(folder.write("changed.system.xml", changed), prefix + ".state.xml");
      FAIL() << from;
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), AllOf(HasSubstr("has the energy"), Not(HasSubstr("\n"))));
    }
  }
}

}  // namespace
}  // namespace taut
