// Everything taut can hand to OpenMM, held against it at a short length.

#include "studies/crosscheck.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/errors.hpp"
#include "base/threads.hpp"
#include "constraints/methods/baumgarte.hpp"
#include "constraints/methods/rattle.hpp"
#include "error_message.hpp"
#include "forcefield/force_field.hpp"
#include "openmm_folder.hpp"
#include "polymer_scene.hpp"
#include "studies/crosscheck_tables.hpp"
#include "studies/crosscheck_verdict.hpp"
#include "studies/openmm_twin.hpp"
#include "systems/openmm/import.hpp"
#include "systems/scene/scene_file.hpp"

namespace taut::crosscheck_tests {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;
using tests::data;
using tests::Files;

Crosscheck held_against_openmm(Scene scene, CrosscheckPlan plan, long steps, long parting) {
  scene.run.steps = steps;
  plan.contestants = contestants({"newton", "rattle"});
  plan.parting_steps = parting;
  plan.samples = 5;
  plan.speed_seconds = 0;
  const int others_have = default_threads();
  plan.threads = others_have + 1;
  const Crosscheck c = crosscheck(scene, plan);
  EXPECT_EQ(available_threads(), others_have);
  return c;
}

// Start, leap-frog, bonds, newton and rattle, all.
void expect_agreement(const Crosscheck& c) {
  for (const Verdict& v : verdicts(c)) EXPECT_EQ(v.finding, Finding::kAgrees) << v.who << ": " << v.why;
}

struct Given {
  const char* name;
  long steps, parting;
};
class CrosscheckOfFiles : public ::testing::TestWithParam<Given> {};

TEST_P(CrosscheckOfFiles, NewtonAndRattleFollowTheTwin) {
  const auto& [name, steps, parting] = GetParam();
  const Files files = data(name);
  CrosscheckPlan plan;
  plan.files = OpenMMFiles{files.system, files.state};
  const Crosscheck c = held_against_openmm(import_openmm(files.system, files.state), plan, steps, parting);
  for (const Track& track : c.tracks) EXPECT_EQ(track.samples.back().step, steps);
  expect_agreement(c);
  // All that parts them is that OpenMM holds waters at lengths rounded to float: with those, newton follows
  // it.
  EXPECT_GT(c.openmm_bonds.rounded, 0);
  EXPECT_GT(*c.openmm_bonds.apart_as_given, 1e-10);
  EXPECT_LT(*c.openmm_bonds.apart_as_given, 1e-5);
  EXPECT_LT(*c.openmm_bonds.apart_with_theirs, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Data, CrosscheckOfFiles,
                         ::testing::Values(Given{"tip3p-216", 100, 5}, Given{"ala2-hbonds-rf", 5, 5}),
                         [](const auto& given) { return "case" + std::to_string(given.index); });

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
  for (const char* name : {"pendulum", "double_pendulum"})
    EXPECT_THAT(error_message([&] { crosscheck(read_scene(find_scene(name)), {}); }),
                AllOf(HasSubstr("OpenMM cannot express it"), HasSubstr("anchor"), Not(HasSubstr("\n"))));
}

// The law's positions are RATTLE's but for what its solves leave, whatever its gains; a drive parts them.
TEST(Crosscheck, BaumgarteTakesRattlesPositionsUnlessItIsDriven) {
  for (Scene scene : {read_scene(find_scene("water"), {"run.dt_fs=1"}),
                      read_scene(find_scene("freely_jointed"), {"build.chains=10"})}) {
    SCOPED_TRACE(scene.name);
    scene.run.steps = 30;
    CrosscheckPlan plan;
    plan.contestants =
        contestants({"baumgarte", "baumgarte:gains=dead-beat", "baumgarte:gains=rattle,reduction=0.3",
                     "baumgarte:gains=critical", "baumgarte:gains=box2d"});
    plan.contestants.push_back({"driven", Baumgarte::Options{.damping = "centred"}});
    plan.parting_steps = 30;
    plan.speed_seconds = 0;
    const Crosscheck c = crosscheck(scene, plan);
    ASSERT_EQ(c.tracks.size(), plan.contestants.size());
    for (const Track& track : c.tracks) {
      SCOPED_TRACE(track.name);
      ASSERT_EQ(track.samples.back().step, 30);
      const double apart = track.samples.back().apart;
      ASSERT_GE(apart, 0) << "both sides are known";
      if (track.name == "driven")
        EXPECT_GT(apart, 1e-7);
      else
        EXPECT_LT(apart, 5e-8);
    }
  }
}

// OpenMM's CCMA takes angles to be at the minimum of their energy, and does not converge far from there.
const std::string kFarFromTheirAngles =
    with(kPolymers, "120, 25", "180, 1") + "switch_nm = 0.9\n[run]\ndt_fs = 10\ntemperature_k = 300\n";

std::vector<std::string> lines_of(const Crosscheck& c) {
  std::vector<std::string> lines;
  for (const Verdict& v : verdicts(c))
    lines.push_back(fmt::format("{}: {}: {}", v.who, name_of(v.finding), v.why));
  return lines;
}

TEST(Crosscheck, NamesARunThatBreaksAndJudgesNothingBesideIt) {
  CrosscheckPlan plan;
  plan.contestants = contestants({"newton", "settle"});
  plan.parting_steps = 100;
  plan.speed_seconds = 0.01;
  const Crosscheck c = crosscheck(read(kFarFromTheirAngles, {"run.steps=500"}), plan);
  EXPECT_TRUE(c.long_enough);
  const std::vector<std::string> lines = lines_of(c);
  ASSERT_EQ(lines.size(), 8u) << testing::PrintToString(lines);
  for (int k = 0; k < 5; ++k)
    EXPECT_THAT(lines[k],
                AllOf(HasSubstr("openmm "), HasSubstr(": failed: step "), HasSubstr("CCMA gave up")));
  EXPECT_THAT(headline(c), AllOf(HasSubstr("failed: openmm rattle"), HasSubstr("CCMA gave up")));
  EXPECT_THAT(lines[5], AllOf(HasSubstr("settle: failed: "), HasSubstr("three-site water")));
  EXPECT_THAT(lines[6], HasSubstr("start: agrees"));
  EXPECT_THAT(lines[7],
              AllOf(HasSubstr("newton: alone: "), HasSubstr("openmm rattle"), Not(HasSubstr("chaos"))));
  EXPECT_EQ(c.tracks[0].samples.back().step, 500);
  EXPECT_GT(c.tracks[0].most_apart(), 0);
  EXPECT_EQ(c.tracks[0].samples.back().apart, -1) << "from a run that is no more";
  EXPECT_THAT(samples_csv(c), Not(HasSubstr("nan")));
  for (const Speed& of : c.speed) {
    EXPECT_EQ(of.failure.empty(), of.us_per_step > 0) << of.who;
    EXPECT_EQ(of.failure.empty(), of.who.starts_with("taut, ")) << of.who << ": " << of.failure;
  }
  EXPECT_EQ(c.speed.size(), 6u);
}

TEST(Crosscheck, DoesNotCallChaosWhatOpenMMsBondsDo) {
  CrosscheckPlan plan;
  plan.contestants = contestants({"newton"});
  plan.agreement = 1e-8;
  plan.speed_seconds = 0;
  const std::string text = with(kFarFromTheirAngles, "180, 1", "120, 1");
  const std::vector<std::string> lines = lines_of(crosscheck(read(text, {"run.steps=60"}), plan));
  EXPECT_THAT(lines, testing::Contains(AllOf(HasSubstr("openmm bonds: differs"), HasSubstr("CCMA gave up"))));
  EXPECT_THAT(lines.back(), AllOf(HasSubstr("newton: parts"), HasSubstr("OpenMM's own bonds are off by"),
                                  Not(HasSubstr("chaos"))));
}

// The plug-in takes taut's own step: all that sets the two apart is round-off of positions, or of the platform's
// forces. A method with other options than taut's would be seen: baumgarte's gains change the trajectory by 1e-6.
struct OnPlatform {
  const char *platform, *precision;
  double apart = 0, apart_with_charges = 0;  // of the runs, at most [nm]
};
class CrosscheckOfThePlugin : public ::testing::TestWithParam<OnPlatform> {};

bool has_plugin(const OnPlatform& on) {
  const Scene scene = read_scene(find_scene("pair"));
  try {
    OpenMMTwin twin(openmm_input(scene), {.h = 0.001,
                                          .platform = on.platform,
                                          .integrator = TwinIntegrator::kTaut,
                                          .precision = on.precision,
                                          .method = "feedforward"});
  } catch (const InputError& absent) {
    EXPECT_THAT(absent.what(),
                AnyOf(HasSubstr("no plug-in for OpenMM"), HasSubstr("no part for the platform"),
                      HasSubstr("OpenMM has no platform")));
    return false;
  }
  return true;
}

// Without charges the platforms of devices compute in double what they are told to; of charges and Lennard-Jones
// numbers OpenMM rounds some to float.
TEST_P(CrosscheckOfThePlugin, TakesTautsTrajectory) {
  const auto& [platform, precision, apart, apart_with_charges] = GetParam();
  if (!has_plugin(GetParam())) GTEST_SKIP() << "no plug-in for " << platform << " here";
  for (const auto& [name, most] : {std::pair("freely_jointed", apart), {"water", apart_with_charges}}) {
    SCOPED_TRACE(name);
    CrosscheckPlan plan;
    plan.platform = platform, plan.precision = precision, plan.integrator = "taut";
    plan.contestants = contestants(plan.usual_methods(), true);
    plan.contestants.push_back({"critical", Baumgarte::Options{.gains = "critical"}});
    plan.speed_seconds = 0;
    const Crosscheck c = crosscheck(read_scene(find_scene(name), {"run.steps=40"}), plan);
    ASSERT_EQ(c.plugged.size(), plan.contestants.size());
    for (const auto& [ours, theirs] : c.plugged) {
      SCOPED_TRACE(theirs.name);
      EXPECT_EQ(theirs.failure, "");
      EXPECT_EQ(theirs.samples.back().step, 40);
      EXPECT_LT(theirs.most_apart(), most);
    }
    if (most < 1e-9) expect_agreement(c);
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, CrosscheckOfThePlugin,
    ::testing::Values(OnPlatform{"Reference", "", 1e-11, 1e-11}, OnPlatform{"CPU", "", 1e-11, 1e-4},
                      OnPlatform{"OpenCL", "double", 1e-11, 1e-5}, OnPlatform{"OpenCL", "mixed", 1e-10, 1e-4},
                      OnPlatform{"OpenCL", "single", 1e-4, 1e-4}),
    [](const auto& given) { return std::string(given.param.platform) + given.param.precision; });

TEST(Crosscheck, RefusesWhatThePluginDoesNotServe) {
  const auto refusal = [](const char* platform, const char* precision,
                          const char* integrator) -> std::string {
    CrosscheckPlan plan;
    plan.platform = platform, plan.precision = precision, plan.integrator = integrator;
    plan.contestants = contestants({"penalty"});
    return error_message([&] { crosscheck(read_scene(find_scene("pair")), plan); });
  };
  EXPECT_THAT(refusal("Reference", "", "tuat"), AllOf(HasSubstr("tuat"), HasSubstr("taut")));
  EXPECT_THAT(refusal("Reference", "single", "openmm"),
              AllOf(HasSubstr("--precision single"), HasSubstr("OpenCL")));
  EXPECT_THAT(refusal("Metal", "", "openmm"), HasSubstr("OpenMM has no platform Metal"));
  if (has_plugin({"Reference", ""})) {
    EXPECT_THAT(refusal("Reference", "", "taut"),
                AllOf(HasSubstr("penalty"), HasSubstr("HarmonicBondForce")));
  }
}

TEST(Crosscheck, SaysWhereThePluginIsLookedFor) {
  setenv("TAUT_OPENMM_PLUGIN", "/nowhere/libtaut_openmm.so", 1);
  const std::string said = error_message([] {
    OpenMMTwin(openmm_input(read_scene(find_scene("pair"))),
               {.h = 0.001, .integrator = TwinIntegrator::kTaut, .method = "newton"});
  });
  unsetenv("TAUT_OPENMM_PLUGIN");
  EXPECT_THAT(said, AllOf(HasSubstr("/nowhere/libtaut_openmm.so"), HasSubstr("does not load")));
}

TEST(Contestants, ByName) {
  const Contestant copy = contestants({"baumgarte:gains=rattle,reduction=0.3"})[0];
  EXPECT_EQ(copy.name, "baumgarte:gains=rattle,reduction=0.3");
  EXPECT_EQ(copy.method.get_if<Baumgarte::Options>()->reduction, 0.3) << "what its name says";
  EXPECT_EQ(contestants({"rattle"})[0].method.get_if<Rattle::Options>()->tolerance, 1e-12);
  EXPECT_EQ(contestants({"rattle:tolerance=1e-4"})[0].method.get_if<Rattle::Options>()->tolerance, 1e-4);
  EXPECT_THROW(contestants({"baumgarte:gains=sideways"}), InputError);
  EXPECT_THROW(contestants({"ratle"}), InputError);
  EXPECT_THROW(contestants({"rattle:critical"}), InputError);
}

// Beads with everything OpenMM has no class for.
OpenMMInput custom_terms(bool periodic) {
  OpenMMInput input;
  input.system = make_system((Eigen::VectorXd(6) << 1, 2, 3, 0, 5, 6).finished(), {{0, 1, 0.9}});
  if (periodic) input.start.box.edge.setConstant(4);
  input.terms.gravity = Vec3(1, -9.81, 2);
  input.terms.pulls = {{2, Vec3(3, -4, 5)}, {5, Vec3(0, 1, 0)}};
  input.terms.restraints = {{1, Vec3(0.8, 0.1, 0), 700}, {5, Vec3(2, 0.7, 1), 300}};
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
    ForceField forces(input.system, input.start.box, input.terms);
    const double ours = forces.evaluate_energy(input.system, input.start);
    Vectors theirs;
    const double energy = twin.forces_at(input.start.x, theirs);
    theirs.col(3) = input.start.f.col(3);  // the anchor, which no force moves
    EXPECT_NEAR(ours, energy, 1e-9 * std::abs(energy));
    EXPECT_LT((input.start.f - theirs).cwiseAbs().maxCoeff(), 1e-9 * theirs.norm());
  }
}

}  // namespace
}  // namespace taut::crosscheck_tests
