// The potential of mean force that tensions integrate to, and how taut scan finds it.

#include "measures/mean_force.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "held_pair.hpp"
#include "measures/csv.hpp"
#include "measures/mean_forces_of_scan.hpp"
#include "taut_command.hpp"

namespace taut::mean_force_tests {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using json = nlohmann::json;
using namespace held_pair;

// ---- The integral

std::vector<HeldLength> pair_at(const std::vector<double>& lengths, double error) {
  std::vector<HeldLength> all;
  for (const double d : lengths) all.push_back({d, {lennard_jones_force(d) + 2 * kT / d, error}, {3, 0}});
  return all;
}

std::vector<double> evenly(double from, double to, int count) {
  std::vector<double> all;
  for (int k = 0; k < count; ++k) all.push_back(from + (to - from) * k / (count - 1));
  return all;
}

// −∫⟨τ⟩dd of two atoms is U − 2kT ln d, what is P(d) ∝ d² exp(−U/kT), and the potential is U.
TEST(MeanForce, OfAPairIntegratesToItsPotential) {
  double before = 0;
  for (const int count : {40, 80, 160}) {
    double worst = 0;
    for (const FreeEnergies& e : integrate_mean_force(pair_at(evenly(0.33, 0.8, count), 0), kT)) {
      const double u = lennard_jones(e.at.length) - lennard_jones(0.8), ln = std::log(e.at.length / 0.8);
      worst = std::max(worst, std::abs(e.potential.value - u));
      EXPECT_NEAR(e.distribution.value, e.potential.value - 2 * kT * ln, 1e-12);
      EXPECT_EQ(e.held.value, e.distribution.value);  // one weight at all lengths
    }
    if (before > 0) {
      EXPECT_LT(worst, before / 12) << count;  // the fourth power of the spacing
    }
    before = worst;
  }
  EXPECT_LT(before, 1e-4);
}

TEST(MeanForce, HasTheErrorsOfItsTensionsAndWeights) {
  const std::vector<FreeEnergies> two =
      integrate_mean_force({{0.3, {5, 0.3}, {2, 0.02}}, {0.5, {4, 0.4}, {3, 0.06}}}, kT);
  EXPECT_NEAR(two[0].held.value, 0.9, 1e-12);
  EXPECT_NEAR(two[0].held.error, 0.1 * 0.5, 1e-12);
  EXPECT_NEAR(two[0].distribution.value, 0.9 - kT * std::log(2.0 / 3), 1e-12);
  EXPECT_NEAR(two[0].potential.error, std::sqrt(0.05 * 0.05 + kT * kT * (1e-4 + 4e-4)), 1e-12);
  EXPECT_NEAR(two[0].potential.value - two[0].distribution.value, 2 * kT * std::log(0.3 / 0.5), 1e-12);
  EXPECT_EQ(two[1].potential.error, 0);
}

struct Potential {
  std::function<double(double)> energy, force;
};

// Steep, wavy and smooth.
const std::vector<Potential> kPotentials = {
    {lennard_jones, lennard_jones_force},
    {[](double r) { return 3 * std::cos(31 * r) * std::exp(-4 * r); },
     [](double r) { return 3 * std::exp(-4 * r) * (31 * std::sin(31 * r) + 4 * std::cos(31 * r)); }},
    {[](double r) { return -14 / r; }, [](double r) { return -14 / (r * r); }}};

// The doubt is as large as what the potential is off, and falls as it does.
TEST(MeanForce, SaysWhereLengthsAreTooFarApart) {
  for (std::size_t p = 0; p < kPotentials.size(); ++p)
    for (const int count : {5, 6, 7, 8, 9, 10, 21, 41, 81}) {
      const auto& [energy, force] = kPotentials[p];
      std::vector<HeldLength> lengths;
      for (const double d : evenly(0.33, 0.8, count))
        lengths.push_back({d, {force(d) + 2 * kT / d, 0}, {3, 0}});
      double off = 0;
      for (const FreeEnergies& e : integrate_mean_force(lengths, kT))
        off = std::max(off, std::abs(e.potential.value - energy(e.at.length) + energy(0.8)));
      EXPECT_GT(*error_of_spacing(lengths), 0.5 * off) << p << " " << count;
      EXPECT_LT(*error_of_spacing(lengths), 10 * off) << p << " " << count;
    }
  EXPECT_FALSE(error_of_spacing(pair_at(evenly(0.33, 0.8, 4), 0)));
}

// Tensions that scatter about a smooth force by their errors say nothing of the spacing.
TEST(MeanForce, DoubtsNoSpacingForScatterOfTensions) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  int doubted = 0;
  for (int trial = 0; trial < 100; ++trial) {
    std::vector<HeldLength> lengths = pair_at(evenly(0.6, 0.8, 11), 2);
    double error = 0;
    for (HeldLength& at : lengths) at.tension.value += at.tension.error * normal(random);
    for (const FreeEnergies& e : integrate_mean_force(lengths, kT))
      error = std::max(error, e.potential.error);
    doubted += *error_of_spacing(lengths) > error;
  }
  EXPECT_LT(doubted, 5);
}

// ---- What a user types

// dH/dλ of a bond whose length changes: the held system's free energy falls by 2kT ln(d/d₀), and its potential is flat.
TEST(Scan, OfABondsLengthGivesItsPotentialOfMeanForce) {
  const TemporaryFolder folder;
  const Undrawn undrawn;
  const std::string out = (folder.path() / "scan").string();
  std::string text = kPair;
  text.erase(text.find("tension_of"));
  for (std::size_t at; (at = text.find("epsilon_kj_mol = 3")) != text.npos;)
    text.replace(at, std::string("epsilon_kj_mol = 3").size(), "epsilon_kj_mol = 1e-9");
  const std::string scene = folder.write("scene.toml", text).string();
  const std::string command =
      "scan " + scene + " --steps 4000 --vary molecule.pair.bonds.0.2=0.3,0.4,0.5 --pmf --seeds 2 --out " +
      out;
  EXPECT_THAT(said(command), AllOf(HasSubstr("potential of mean force along bond 0-1 at 300 K"),
                                   HasSubstr("no other rigid bond is coupled to this one")));
  const json all = json::parse(said("measure --from auto --json " + out));
  ASSERT_EQ(all.size(), 4u);
  const json& points = all[3]["mean_force"];
  ASSERT_EQ(points.size(), 3u);
  for (const json& p : points) {
    const json& told = p["potential_kj_mol"]["error"];
    const double d = p["length_nm"], error = told.is_null() ? 0 : told.get<double>();
    EXPECT_NEAR(p["held_kj_mol"]["value"].get<double>(), -2 * kT * std::log(d / 0.5), 4 * error + 0.02);
    EXPECT_NEAR(p["potential_kj_mol"]["value"].get<double>(), 0, 4 * error + 0.02);
    EXPECT_LT(error, 0.5);
  }
  EXPECT_EQ(csv_rows(contents(out + "/mean_force.csv")).size(), 4u);
  const auto runs = csv_rows(contents(out + "/runs.csv"));  // each has random numbers of its own
  ASSERT_EQ(runs.size(), 7u);
  for (int k = 1; k <= 6; ++k) EXPECT_EQ(runs[k][1], std::to_string(k));
  EXPECT_THAT(contents(out + "/commands.txt"), HasSubstr("run.seed=6"));
}

TEST(Scan, SaysWhyThereIsNoPotentialOfMeanForce) {
  const TemporaryFolder folder;
  const Undrawn undrawn;
  const std::string scene = folder.write("scene.toml", kPair).string();
  const std::string out = " --out " + (folder.path() / "scan").string();
  const auto refused = [&](const std::string& rest) {
    return said("scan " + scene + " --pmf " + rest + out, 2);
  };
  const std::string lengths = "--vary molecule.pair.bonds.0.2=0.4,0.5 ";
  EXPECT_THAT(refused("--vary run.dt_fs=1,2"), HasSubstr("no rigid bond has several lengths"));
  EXPECT_THAT(said("scan held_chain --pmf --vary molecule.chain.bonds.0.2=0.3,0.4" + out, 2),
              HasSubstr("tied together by rigid bonds"));
  EXPECT_THAT(
      said("scan held_chain --pmf --set run.tension_of=[[0,1]] --vary molecule.chain.bonds.0.2=0.3,0.4" + out,
           2),
      HasSubstr("bond 1-2, which run.tension_of does not name"));
  EXPECT_THAT(refused(lengths + "--set run.thermostat=none"), HasSubstr("run.thermostat"));
  EXPECT_THAT(refused(lengths + "--set 'run.temperature_k=[[0, 300], [9, 400]]'"),
              HasSubstr("run.temperature_k"));
  EXPECT_THAT(
      refused(lengths +
              "--set 'bias=[{name=\"b\", variable=\"distance\", groups=[0, 1], at_nm=1, k_kj_mol_nm2=9}]'"),
      AllOf(HasSubstr("bias b"), HasSubstr("held rigid")));
  EXPECT_THAT(refused(lengths + "--method penalty --dt-fs 0.5"), HasSubstr("holds bonds by springs"));
  EXPECT_THAT(refused(lengths + "--set run.seed=77"), HasSubstr("--set run.seed: --pmf gives each run"));
  EXPECT_THAT(said("scan " + scene + " --seeds 2 --set run.seed=77" + out, 2),
              HasSubstr("--set run.seed: --seeds gives each run"));
  EXPECT_THAT(refused("--vary molecule.pair.bonds.0.2=0.4,0.4 --set run.dt_fs=1"),
              HasSubstr("no rigid bond has several lengths"));
  EXPECT_FALSE(fs::exists(folder.path() / "scan"));
  EXPECT_THAT(
      said("scan " + scene + " --steps 10 " + lengths + out),
      HasSubstr(
          "no potential of mean force along bond 0-1: the rows at 0.4 nm are too few to have an error"));
}

// What the numbers alone do not say is in the words, in JSON and in the table.
TEST(Scan, SaysWhatAPotentialOfMeanForceIsNot) {
  const TemporaryFolder folder;
  const Undrawn undrawn;
  std::string text = kPair;
  text.erase(text.find("exclude"), std::string("exclude = \"none\"\n").size());
  text.erase(text.find("tension_of"));
  text.replace(text.find("count = 1"), 9, "count = 2");
  const std::string scene =
      folder.write("scene.toml", text + "seed = 77\n[build]\nbox_nm = 4\n[forcefield]\ncutoff_nm = 1\n")
          .string();
  const std::string out = (folder.path() / "scan").string();
  const std::string words =
      said("scan " + scene + " --steps 2000 --vary molecule.pair.bonds.0.2=0.3,0.4,0.5 --pmf --out " + out);
  EXPECT_THAT(words, AllOf(HasSubstr("run.seed = 77 is replaced: the runs have seeds from 1 to 3"),
                           HasSubstr("2 bonds are held at one length together"),
                           HasSubstr("0 and 1 do not act on each other (exclude), nor do the atoms of 1")));
  const json curve = json::parse(said("measure --from auto --json " + out)).back();
  EXPECT_TRUE(curve["spacing_error_kj_mol"].is_null());
  EXPECT_EQ(curve["doubts"].size(), 1u);
  EXPECT_EQ(curve["notes"].size(), 2u);
  EXPECT_THAT(curve["corrected"].get<std::string>(), HasSubstr("no other rigid bond"));
  EXPECT_THAT(
      contents(out + "/mean_force.csv"),
      AllOf(HasSubstr("spacing_error_kj_mol,corrected,notes,doubts"), HasSubstr("3 lengths cannot tell")));
}

// A weight that drifts over its few rows has no error, and is not exact for that.
TEST(Scan, HasNoPotentialWhereAWeightHasNoError) {
  const TemporaryFolder folder;
  const Undrawn undrawn;
  const std::string scene = folder.write("scene.toml", kPair).string();
  const std::string out = (folder.path() / "scan").string();
  said("scan " + scene + " --steps 2000 --vary molecule.pair.bonds.0.2=0.4,0.5 --pmf --out " + out);
  const std::string log = contents(out + "/001/log.csv");
  std::string drifting;
  double weight = 1;
  for (std::size_t at = 0, end; (end = log.find('\n', at)) != log.npos; at = end + 1) {
    const std::string row = log.substr(at, end - at);
    drifting += at == 0 ? row : fmt::format("{},{}", row.substr(0, row.rfind(',')), weight += 0.1);
    drifting += "\n";
  }
  folder.write("scan/001/log.csv", drifting);
  EXPECT_THAT(said("measure " + out), HasSubstr("the rows at 0.4 nm are too few for ⟨w⟩ to have an error"));
}

// More pairs than one word of a command line holds.
TEST(Scan, RefusesMoreBondsThanACommandLineNames) {
  const TemporaryFolder folder;
  std::string text = kPair;
  text.erase(text.find("tension_of"));
  text.replace(text.find("count = 1"), 9, "count = 9000");
  const std::string scene =
      folder.write("scene.toml", text + "[build]\nbox_nm = 60\n[forcefield]\ncutoff_nm = 1\n").string();
  EXPECT_THAT(said("scan " + scene + " --pmf --vary molecule.pair.bonds.0.2=0.3,0.4 --out " +
                       (folder.path() / "scan").string(),
                   2),
              HasSubstr("9000 bonds change their length, more than a command line can name"));
}
TEST(MeanForce, IsRefusedWhereAnchorsMove) {
  Scene scene = read(kPair);
  EXPECT_EQ(flaw_of_mean_force(scene), "");
  scene.motions.push_back({.atoms = {0}, .velocity = Vec3(1, 0, 0)});
  EXPECT_THAT(flaw_of_mean_force(scene), HasSubstr("motion.0: pulls at the bonds it moves"));
}

}  // namespace
}  // namespace taut::mean_force_tests
