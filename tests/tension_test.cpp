// The tension that the log has of a bond, beside closed forms; every bond's load over a run.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "error_message.hpp"
#include "held_pair.hpp"
#include "measures/csv.hpp"
#include "simulation/simulation.hpp"
#include "taut_command.hpp"

namespace taut::tension_tests {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using json = nlohmann::json;
using namespace held_pair;

// ---- Tensions beside closed forms

struct Means {
  Estimate tension, weight;
};
Means means_of(const Scene& scene) {
  Simulation simulation(scene);
  RunningMean tension, weight;
  simulation.run([&](const Record& r) {
    tension.add(r.held->tension);
    weight.add(r.held->weight);
  });
  return {tension.estimate(), weight.estimate()};
}

// Between two atoms the tension is −U'(d) + μv²/d, its mean −U'(d) + 2kT/d; no other constraint is coupled, so that the
// mass along the distance is μ.
TEST(Tension, OfAPairIsTheForceAndTheCentrifugalForce) {
  for (const char* method : {"newton", "rattle", "baumgarte", "feedforward"})
    for (const double d : {0.35, 0.5}) {
      const Means found = means_of(
          read(kPair, {fmt::format("molecule.pair.bonds.0.2={}", d), std::string("method.name=") + method}));
      EXPECT_LT(found.tension.error, 0.6);
      EXPECT_NEAR(found.tension.value, lennard_jones_force(d) + 2 * kT / d, 4 * found.tension.error)
          << method;
      EXPECT_NEAR(found.weight.value, std::sqrt(40.0 * 20 / 60), 1e-7) << method;
    }
}

// A rigid triangle with sides b, b and d, the masses m: at all orientations ∫√det A δ(σ) is √(I₁I₂I₃), so that
// ⟨τ⟩ = kT ∂ ln √(I₁I₂I₃)/∂d. In the trimer whose two bonds alone are rigid c = cos θ between
// bond vectors has P(c) ∝ √(4 − c²), d² = 2b²(1 + c), so P(d) ∝ d √(4 − c²), which is exp(−A/kT)⟨w⟩.
TEST(Tension, OfATrianglesThirdSideGivesTheTrimersDistribution) {
  const std::string text = in_a_bath(
      "trimer", "atoms = [{name = \"A\", mass_u = 15}]\nunits = 3\nbonds = [[0, 1, 0.3], [0, -1, 0.4]]",
      100000, "[0, -1]");
  const double b = 0.3;
  const auto log_inertia = [&](double d) {  // ½ ln I₁I₂I₃ but for a constant
    const double height = std::sqrt(b * b - d * d / 4), ix = 2.0 / 3 * height * height, iy = d * d / 2;
    return 0.5 * std::log(ix * iy * (ix + iy));
  };
  const auto log_p = [&](double d) {
    const double c = d * d / (2 * b * b) - 1;
    return std::log(d * std::sqrt(4 - c * c));
  };
  const auto weight = [&](double d) { return std::exp(log_p(d) - log_inertia(d)); };
  double ratio = 0;
  for (const double d : {0.15, 0.3, 0.5}) {
    const Means found = means_of(read(text, {fmt::format("molecule.trimer.bonds.1.2={}", d)}));
    const double slope = (log_inertia(d + 1e-6) - log_inertia(d - 1e-6)) / 2e-6;
    EXPECT_LT(found.tension.error, 1.5);
    EXPECT_NEAR(found.tension.value, kT * slope, 4 * found.tension.error) << d;
    if (ratio == 0) ratio = found.weight.value / weight(d);
    EXPECT_NEAR(found.weight.value / weight(d), ratio, 1e-6 * ratio) << d;
  }
}

// A chain of N = 4 freely jointed bonds, its ends held apart: Fixman's potential makes it freely jointed, so that
// −∫⟨τ⟩ − kT ln d = −kT ln P(d), ⟨τ⟩ = kT d ln(P/d)/dd, of Treloar's P(r)/r² (1946, doi:10.1039/TF9464200077).
// Without it P is that of rigid bonds, and its weight is not constant.
TEST(Tension, OfAFreelyJointedChainsEndsIsItsElasticity) {
  const std::string text = in_a_bath(
      "chain", "atoms = [{name = \"B\", mass_u = 15}]\nunits = 5\nbonds = [[0, 1, 0.3], [0, -1, 0.6]]",
      100000, "[0, -1]");
  const int N = 4;
  const auto log_p = [&](double r) {  // ln P/r²
    double sum = 0, binomial = 1;
    for (int k = 0; k <= N && N - 2 * k > r / 0.3; ++k) {
      sum += (k % 2 ? -1 : 1) * binomial * std::pow(N - 2 * k - r / 0.3, N - 2);
      binomial *= static_cast<double>(N - k) / (k + 1);
    }
    return std::log(sum / r);
  };
  for (const double d : {0.5, 1.1}) {
    const Scene scene =
        read(text, {fmt::format("molecule.chain.bonds.1.2={}", d), "run.metric_correction=true"});
    const Means found = means_of(scene);
    const double slope = (log_p(d + 1e-6) - log_p(d - 1e-6)) / 2e-6 + 1 / d;
    EXPECT_LT(found.tension.error, 1.2);
    EXPECT_NEAR(found.tension.value, kT * slope, 4 * found.tension.error) << d;
    EXPECT_NEAR(found.weight.value, d, 1e-12);
  }
  EXPECT_GT(means_of(read(text)).weight.error, 0);
}

// Of five atoms all ten distances are held, and one bond is left out: the log has what bond_tensions has.
TEST(Tension, OfAnOverdeterminedClusterIsSharedAsInTheTrajectory) {
  const std::string text =
      R"(run = {dt_fs = 0.1, steps = 10, log_every = 10, temperature_k = 300, redundant = "drop"}
[build]
kind = "atoms"
atoms = [[0, 0, 0, 10], [0.3, 0, 0, 12], [0.1, 0.3, 0, 14], [0.1, 0.1, 0.3, 16], [0.15, 0.12, -0.3, 18]]
bonds = [[0, 1, 0.3], [0, 2, 0.31622776601683794], [1, 2, 0.36055512754639896], [0, 3, 0.33166247903554],
  [1, 3, 0.37416573867739417], [2, 3, 0.36055512754639896], [0, 4, 0.35623026261113757],
  [1, 4, 0.35623026261113757], [2, 4, 0.35341194094144583], [3, 4, 0.6023288138549]]
)";
  const Scene all = read(text);
  for (const RigidBond& bond : all.system.bonds) {
    Scene scene = all;
    scene.run.tension_of = {{bond.i, bond.j}};
    Simulation simulation(scene);
    HeldTension held{};
    simulation.run([&](const Record& r) { held = *r.held; });
    const Eigen::VectorXd shared = simulation.bond_tensions();
    const auto k = &bond - all.system.bonds.data();
    EXPECT_NEAR(held.tension, shared[k], 0.01 * shared.cwiseAbs().maxCoeff()) << k;
    EXPECT_TRUE(std::isnan(held.weight));
  }
}

TEST(Tension, IsRefusedOfWhatIsNoRigidBond) {
  const auto refused = [](const std::string& key, const std::string& more = "") {
    return error_message([&] { read(kPair, {"run.tension_of=" + key, "place.0.count=2" + more}); });
  };
  EXPECT_THAT(refused("[[0, 2]]"), HasSubstr("run.tension_of[0]: no rigid bond is between 0 and 2"));
  EXPECT_THAT(refused("[[0, 4]]"), HasSubstr("no atom 4"));
  EXPECT_THAT(refused("[[0, 0.5]]"), HasSubstr("no atom 0.5"));
  EXPECT_THAT(refused("[[0, 1], [1, 0]]"), HasSubstr("twice"));
  EXPECT_EQ(read(kPair, {"run.tension_of=[[-1, -2]]"}).run.tension_of[0], (std::array{0, 1}));
}

// A chain of four beads hangs at rest from an anchor: bond k carries what is below it.
TEST(Loads, AreMeasuredOfEveryBond) {
  const TemporaryFolder folder;
  const std::string scene = folder
                                .write("hanging.toml", R"(run = {dt_fs = 1, steps = 100, log_every = 10}
[build]
kind = "atoms"
atoms = [[0, 0, 0, 0], [0, -1, 0, 2], [0, -2, 0, 3], [0, -3, 0, 5]]
bonds = [[0, 1, 1], [1, 2, 1], [2, 3, 1]]
gravity_nm_ps2 = [0, -10, 0]
)")
                                .string();
  const std::string out = (folder.path() / "out").string(), measured = (folder.path() / "measured").string();
  said("run " + scene + " --quiet --out " + out);
  EXPECT_THAT(said("measure --tensions " + out, 2), HasSubstr("run.trajectory=h5md"));
  said("run " + scene + " --quiet --overwrite --set run.trajectory=h5md run.trajectory_every=5 --out " + out);
  const std::string words = said("measure --tensions " + out + " --out " + measured);
  EXPECT_THAT(words, HasSubstr("tension of 3 bonds in 21 frames"));
  const auto rows = csv_rows(contents(measured + "/loads.csv"));
  ASSERT_EQ(rows.size(), 4u);
  for (int k = 0; k < 3; ++k) {
    const double carried = std::vector<double>{100, 80, 50}[k];
    for (const int column : {2, 4, 5}) EXPECT_NEAR(std::stod(rows[k + 1][column]), carried, 1e-6);
  }
  EXPECT_EQ(rows[1][1], "0-1");
  EXPECT_LT(words.find("0-1"), words.find("2-3"));  // the largest first
  EXPECT_TRUE(fs::exists(measured + "/loads_in_time.csv"));
  // A pendulum let go from the horizontal: 0 there, 3mg at its lowest.
  const std::string swings =
      folder
          .write("swings.toml", R"(run = {dt_fs = 1, steps = 1000, trajectory = "h5md", trajectory_every = 1}
[build]
kind = "atoms"
atoms = [[0, 0, 0, 0], [1, 0, 0, 2]]
bonds = [[0, 1, 1]]
gravity_nm_ps2 = [0, -10, 0]
)")
          .string();
  said("run " + swings + " --quiet --out " + out + "2");
  const json load = json::parse(said("measure --tensions --json " + out + "2"))["tensions"][0];
  EXPECT_NEAR(load["least_kj_mol_nm"], 0, 1e-3);
  EXPECT_NEAR(load["most_kj_mol_nm"], 60, 1e-3);
  EXPECT_NEAR(load["largest_at_ps"], 0.5863, 2e-3);  // a quarter of 1.18034·2π√(L/g)
  EXPECT_THAT(said("measure --tensions " + out + " " + out, 2), HasSubstr("--join"));
}

}  // namespace
}  // namespace taut::tension_tests
