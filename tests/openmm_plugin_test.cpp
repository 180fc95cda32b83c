// The plug-in under the OpenMM that it is built for. Python's tests have the programs of openmm.app besides.

#include <OpenMM.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <sstream>

#include "error_message.hpp"
#include "openmm_plugin/device_plan.hpp"
#include "openmm_plugin/step_kernel.hpp"

// OpenMM keeps what plug-ins register until the process ends, and never deletes it.
extern "C" __attribute__((visibility("default"))) const char* __lsan_default_suppressions() {
  return "leak:registerSerializationProxies\nleak:registerKernelFactor\n";
}

namespace {

using OpenMM::Vec3;

constexpr double kOh = 0.09572, kHh = 0.15139;  // of TIP3P [nm]

// Stands for the platform of a device for which the plug-in has no part.
class OtherDevice final : public OpenMM::Platform {
 public:
  const std::string& getName() const override { return name_; }
  double getSpeed() const override { return 1; }
  bool supportsDoublePrecision() const override { return true; }

 private:
  std::string name_ = "OtherDevice";
};

void load_plugin() {
  static const bool loaded = [] {
    OpenMM::Platform::registerPlatform(new OtherDevice);
    const std::string root = TAUT_OPENMM_ROOT;
    OpenMM::Platform::loadPluginsFromDirectory(root.empty() ? OpenMM::Platform::getDefaultPluginsDirectory()
                                                            : root + "/lib/plugins");
    OpenMM::Platform::loadPluginLibrary(TAUT_OPENMM_PLUGIN);
    return true;
  }();
  ASSERT_TRUE(loaded);
}

OpenMM::Integrator* make_integrator(const std::string& attributes, const std::string& options = "") {
  std::stringstream xml;
  xml << "<Integrator type=\"TautIntegrator\" version=\"1\" " << attributes << "><Options " << options
      << "/></Integrator>";
  return OpenMM::XmlSerializer::deserialize<OpenMM::Integrator>(xml);
}

bool has(const std::string& platform) {
  for (int n = 0; n < OpenMM::Platform::getNumPlatforms(); ++n)
    if (OpenMM::Platform::getPlatform(n).getName() == platform) return true;
  return false;
}

// A droplet of TIP3P: waters on a cubic grid.
struct Droplet {
  OpenMM::System system;
  std::vector<Vec3> x;

  Droplet() {
    auto* const pairs = new OpenMM::NonbondedForce;
    for (int n = 0; n < 27; ++n) {
      const Vec3 at(0.31 * (n % 3), 0.31 * (n / 3 % 3), 0.31 * (n / 9));
      const double half = kHh / 2, up = std::sqrt(kOh * kOh - half * half), turn = n % 2 ? 1 : -1;
      for (const Vec3& of : {Vec3(), Vec3(half, up * turn, 0), Vec3(-half, up * turn, 0)})
        x.push_back(at + of);
      system.addParticle(15.999);
      system.addParticle(1.008);
      system.addParticle(1.008);
      pairs->addParticle(-0.834, 0.315, 0.636);
      pairs->addParticle(0.417, 0.1, 0);
      pairs->addParticle(0.417, 0.1, 0);
      const int o = 3 * n;
      for (const auto& [i, j, d] : {std::tuple(o, o + 1, kOh), {o, o + 2, kOh}, {o + 1, o + 2, kHh}}) {
        system.addConstraint(i, j, d);
        pairs->addException(i, j, 0, 0.1, 0);
      }
    }
    system.addForce(pairs);
    system.addForce(new OpenMM::CMMotionRemover);
  }

  double bond_error(const std::vector<Vec3>& now) const {
    double worst = 0;
    for (int k = 0; k < system.getNumConstraints(); ++k) {
      int i = 0, j = 0;
      double d = 0;
      system.getConstraintParameters(k, i, j, d);
      const Vec3 r = now[j] - now[i];
      worst = std::max(worst, std::abs(std::sqrt(r.dot(r)) / d - 1));
    }
    return worst;
  }
};

// A run of the droplet. Its Context dies before its integrator.
struct Trajectory {
  Droplet droplet;
  std::unique_ptr<OpenMM::Integrator> integrator;
  std::unique_ptr<OpenMM::Context> context;

  explicit Trajectory(OpenMM::Integrator* made, const std::string& platform = "Reference")
      : integrator(made) {
    context = std::make_unique<OpenMM::Context>(droplet.system, *integrator,
                                                OpenMM::Platform::getPlatformByName(platform));
    context->setPositions(droplet.x);
  }
  std::vector<Vec3> x() const { return context->getState(OpenMM::State::Positions).getPositions(); }
  double energy() const {
    const OpenMM::State state = context->getState(OpenMM::State::Energy);
    return state.getKineticEnergy() + state.getPotentialEnergy();
  }
};

struct Case {
  std::string platform, method;
  double error;
};
class OpenMMPlugin : public testing::TestWithParam<Case> {};

TEST_P(OpenMMPlugin, HoldsBondsAndEnergy) {
  load_plugin();
  const auto& [platform, method, error] = GetParam();
  if (!has(platform)) GTEST_SKIP() << "OpenMM's platform " << platform << " is not here (libopenmm-plugins)";
  Trajectory run(make_integrator("stepSize=\"0.001\" method=\"" + method + "\""), platform);
  OpenMM::LocalEnergyMinimizer::minimize(*run.context, 10, 100);
  run.context->setVelocitiesToTemperature(300, 1);
  run.integrator->step(10);
  const double before = run.energy();
  run.integrator->step(100);
  EXPECT_LT(run.droplet.bond_error(run.x()), error);
  EXPECT_NEAR(run.energy(), before, 1);
  EXPECT_NEAR(run.context->getState(0).getTime(), 0.11, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(All, OpenMMPlugin,
                         testing::Values(Case{"Reference", "feedforward", 1e-7},
                                         Case{"Reference", "baumgarte", 1e-4},
                                         Case{"Reference", "newton", 1e-9}, Case{"CPU", "feedforward", 1e-7}),
                         [](const auto& one) { return one.param.platform + "_" + one.param.method; });

// Two waters, an O-H beside another, a free atom, and a site: what a device holds, and how.
taut::HeldBonds two_waters_and_others() {
  taut::HeldBonds held{{16, 1, 1, 0, 12, 1, 20, 16, 1, 1, 14, 1}, {}};
  for (const int o : {0, 7}) {
    held.bonds.push_back({o, o + 1, kOh});
    held.bonds.push_back({o, o + 2, kOh});
    held.bonds.push_back({o + 1, o + 2, kHh});
  }
  held.bonds.push_back({4, 5, 0.11});
  held.bonds.push_back({10, 11, 0.10});
  return held;
}

TEST(OpenMMPluginPlatforms, AreThoseThatCanRunTheStep) {
  load_plugin();
  const std::vector<std::string> step = {taut::TautStepKernel::Name()};
  EXPECT_TRUE(OpenMM::Platform::getPlatformByName("Reference").supportsKernels(step));
  EXPECT_FALSE(OpenMM::Platform::getPlatformByName("OtherDevice").supportsKernels(step));
}

TEST(OpenMMPluginDevicePlan, PutsClustersOfOneShapeSideBySide) {
  const taut::DevicePlan plan = taut::plan_for_device(two_waters_and_others(), {});
  ASSERT_EQ(plan.shapes.size(), 3u);
  for (const taut::DeviceShape& shape : plan.shapes) {
    if (shape.atoms == 3) {
      EXPECT_EQ(shape.atom, (std::vector<int>{0, 7, 1, 8, 2, 9}));
      EXPECT_EQ(shape.length, (std::vector<double>{kOh, kOh, kOh, kOh, kHh, kHh}));
    }
    if (shape.atoms == 2) {  // of different masses and lengths
      EXPECT_EQ(shape.atom, (std::vector<int>{4, 10, 5, 11}));
      EXPECT_EQ(shape.length, (std::vector<double>{0.11, 0.10}));
    }
    if (shape.atoms == 1) {
      EXPECT_EQ(shape.atom, (std::vector<int>{6}));
    }
  }
  EXPECT_EQ(plan.shapes.front().guess[3], (std::array<double, 3>{3, -3, 1}));
}

TEST(OpenMMPluginDevicePlan, RefusesWhatDevicesDoNotHold) {
  const auto refused = [](const taut::HeldBonds& held, const taut::HoldSettings& settings) {
    return taut::error_message<std::exception>([&] { taut::plan_for_device(held, settings); });
  };
  const taut::HeldBonds some = two_waters_and_others();
  EXPECT_NE(refused(some, {0.002, "newton", {}}).find("take \"feedforward\" or \"baumgarte\""),
            std::string::npos);
  EXPECT_NE(refused(some, {0.002, "baumgarte", {{"sweeps", "2"}}}).find("take sweeps=0"), std::string::npos);
  EXPECT_EQ(refused(some, {0.002, "baumgarte", {}}), "no error");
}

// Carries out the plan as a group of threads does, one number after the other.
std::vector<double> solve_by(const taut::GroupPlan& plan, const std::vector<std::vector<double>>& a,
                             const std::vector<double>& b) {
  std::vector<double> number;
  for (int e = 0; e < plan.entries(); ++e) number.push_back(a[plan.row[e]][plan.column[e]]);
  number.insert(number.end(), b.begin(), b.end());
  double* const x = number.data() + plan.entries();
  const int rounds = static_cast<int>(plan.rounds.size()) - 1;
  for (int n = 0; n < rounds; ++n) {
    for (int p = plan.rounds[n]; p < plan.rounds[n + 1]; ++p)
      number[plan.pivots[p]] = 1 / number[plan.pivots[p]];
    const std::vector<double> before = number;  // threads see each other's changes only after the round
    for (int t = plan.target_rounds[n]; t < plan.target_rounds[n + 1]; ++t)
      for (int m = plan.change_start[t]; m < plan.change_start[t + 1]; ++m)
        number[plan.targets[t]] -=
            before[plan.changes[3 * m]] * before[plan.changes[3 * m + 1]] * before[plan.changes[3 * m + 2]];
  }
  for (int n = rounds - 1; n >= 0; --n)
    for (int p = plan.rounds[n]; p < plan.rounds[n + 1]; ++p) {
      const int k = plan.pivots[p];
      for (int m = plan.later_start[p]; m < plan.later_start[p + 1]; ++m)
        x[k] -= number[plan.later[2 * m]] * x[plan.later[2 * m + 1]];
      x[k] *= number[k];
    }
  return {x, x + b.size()};
}

// A ladder, whose rungs make it rings, with a branch at each corner.
TEST(OpenMMPluginGroupPlan, SolvesAnyClusterInFewRounds) {
  std::vector<std::array<int, 2>> bonds;
  const int rungs = 40;
  for (int n = 0; n < rungs; ++n) {
    bonds.push_back({2 * n, 2 * n + 1});
    for (int side = 0; side < 2; ++side) {
      if (n > 0) bonds.push_back({2 * n - 2 + side, 2 * n + side});
      bonds.push_back({2 * rungs + 2 * n + side, 2 * n + side});
    }
  }
  std::vector<double> inv_masses(4 * rungs, 0.1);
  inv_masses[7] = 0;  // never moves
  const int n = static_cast<int>(bonds.size());
  std::vector<std::vector<double>> a(n, std::vector<double>(n));
  std::vector<double> x(n), b(n);
  for (int k = 0; k < n; ++k) {
    x[k] = 1 + k % 7;
    for (int l = 0; l < n; ++l) {
      for (const int end_k : {0, 1})
        for (const int end_l : {0, 1})
          if (bonds[k][end_k] == bonds[l][end_l])  // not symmetric, as the bonds before and after a step
            a[k][l] +=
                (end_k == end_l ? 1 : -1) * inv_masses[bonds[k][end_k]] * (k == l ? 1 : 0.3 + 0.01 * k);
    }
  }
  for (int k = 0; k < n; ++k)
    for (int l = 0; l < n; ++l) b[k] += a[k][l] * x[l];
  const taut::GroupPlan plan = taut::plan_group(bonds, inv_masses);
  const std::vector<double> solved = solve_by(plan, a, b);
  for (int k = 0; k < n; ++k) EXPECT_NEAR(solved[k], x[k], 1e-10) << k;
  EXPECT_LT(plan.rounds.size() - 1, 30u);
  EXPECT_LT(plan.entries(), 20 * n);
}

// Every second bond of a chain in a round, where eating it from its ends would take 101.
TEST(OpenMMPluginGroupPlan, HalvesAChainInEveryRound) {
  std::vector<std::array<int, 2>> chain;
  for (int k = 0; k < 200; ++k) chain.push_back({k, k + 1});
  EXPECT_EQ(taut::plan_group(chain, std::vector<double>(201, 0.1)).rounds.size() - 1, 8u);
}

TEST(OpenMMPluginDevicePlan, GivesLargeClustersAndThoseWithAnAnchorToGroups) {
  taut::HeldBonds held{std::vector<double>(16, 14.0), {}};
  for (int i = 0; i < 9; ++i) held.bonds.push_back({i, i + 1, 0.15});  // nine bonds
  held.masses[10] = 0;
  held.bonds.push_back({10, 11, 0.1});
  held.bonds.push_back({12, 10, 0.1});  // of the same anchor: clusters that share no moving atom
  held.bonds.push_back({13, 14, 0.1});
  const taut::DevicePlan plan = taut::plan_for_device(held, {});
  ASSERT_EQ(plan.shapes.size(), 5u);
  EXPECT_EQ(plan.shapes[0].group->unknowns(), 9);
  for (const int anchored : {1, 2}) {
    EXPECT_TRUE(plan.shapes[anchored].group);
    EXPECT_EQ(plan.shapes[anchored].atom, (std::vector<int>{10 + anchored, 10}));
  }
  EXPECT_FALSE(plan.shapes[3].group);  // an OH
  EXPECT_EQ(plan.shapes[4].atom, std::vector<int>{15});
}

}  // namespace
