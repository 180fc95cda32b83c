// Scenes with biases: statistics in closed form, walls that move, checkpoints, and what bad ones are told.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "forcefield/force_field.hpp"
#include "kept_state.hpp"
#include "md/units.hpp"
#include "scene_text.hpp"
#include "simulation/simulation.hpp"
#include "systems/builders/biases.hpp"

namespace taut::bias_scenes_tests {
namespace {

using testing::HasSubstr;
using Variable = Bias::Variable;
constexpr double kPi = std::numbers::pi;

const std::string kPairOfBeads = R"([molecule.bead]
atoms = [{name = "B", mass_u = 40}]
[[place]]
molecule = "bead"
centres_nm = [[0, 0, 0], [0.4, 0, 0.3]]
[[bias]]
name = "arm"
variable = "distance"
groups = [[0], [1]]
at_nm = 0.5
k_kj_mol_nm2 = 200
[run]
dt_fs = 5
steps = 200000
log_every = 10
temperature_k = 300
thermostat = "langevin"
friction_per_ps = 2
seed = 3
[method]
name = "none"
)";

// p(r) ∝ r² exp(−k(r − at)²/2kT)
TEST(Bias, AHarmonicDistanceHasItsDistribution) {
  const double kT = kBoltzmann * 300;
  double norm = 0, mean = 0, force = 0;
  for (double r = 0.0005; r < 3; r += 0.001) {
    const double p = r * r * std::exp(-0.5 * 200 * (r - 0.5) * (r - 0.5) / kT);
    norm += p, mean += p * r, force += p * -200 * (r - 0.5);
  }
  Simulation simulation(read(kPairOfBeads));
  const Summary summary = simulation.run({});
  ASSERT_EQ(summary.biases.size(), 1u);
  const auto& [value, pull, lost] = summary.biases[0];
  EXPECT_LT(value.error, 0.01);
  EXPECT_NEAR(value.value, mean / norm, 4 * value.error);
  EXPECT_NEAR(pull.value, force / norm, 4 * pull.error);
  EXPECT_EQ(lost, 0);
}

// The density of the ends of n freely jointed bonds of unit length at the distance r, but for a factor: Treloar 1946
// (doi:10.1039/TF9464200077).
double ends_of_freely_jointed(int n, double r) {
  double sum = 0, choose = 1;
  for (int k = 0; k <= 0.5 * (n - r); ++k) {
    sum += (k % 2 ? -1 : 1) * choose * std::pow(n - 2 * k - r, n - 2);
    choose *= static_cast<double>(n - k) / (k + 1);
  }
  return sum / r;
}

// ⟨ξ⟩ and the mean force along it, by p(r) r² exp(−½k(r − at)²/kT)
TEST(Bias, HeldEndsPullAsThoseOfAFreelyJointedChain) {
  const Scene scene = read_scene(find_scene("held_chain"),
                                 {"run.metric_correction=true", "bias.0.at_nm=2.4", "run.steps=300000"});
  const double kT = kBoltzmann * 300;
  double norm = 0, mean = 0, force = 0;
  for (double r = 0.0005; r < 3; r += 0.001) {
    const double p =
        ends_of_freely_jointed(10, r / 0.3) * r * r * std::exp(-0.5 * 50 * std::pow(r - 2.4, 2) / kT);
    norm += p, mean += p * r, force -= p * 50 * (r - 2.4);
  }
  Simulation simulation(scene);
  const Summary::OfBias found = simulation.run({}).biases.at(0);
  EXPECT_LT(found.force.error, 0.03 * force / norm);
  EXPECT_NEAR(found.value.value, mean / norm, 4 * found.value.error);
  EXPECT_NEAR(found.force.value, force / norm, 4 * found.force.error);
}

// Two free beads of reduced mass μ behind a centre that moves: ξ = at + v(t − sin(ωt)/ω), ω² = k/μ. What moves the
// centre does work; the energy less this work stays.
TEST(Bias, FreeBeadsFollowAMovingCentre) {
  const std::vector<std::string> moving = {
      "bias.0.rate_nm_ps=0.05", "run.thermostat=none", "run.temperature_k=0",
      "run.steps=4000",         "run.dt_fs=1",         "run.log_every=500"};
  std::string text = SceneText{kPairOfBeads}.with("friction_per_ps = 2\n", "").text;
  const Scene scene = read(text, moving);
  EXPECT_EQ(scene.terms.biases[0].rate, 0.05);
  Simulation simulation(scene);
  const double w = std::sqrt(200.0 / 20), v = 0.05;
  simulation.run([&](const Record& r) {
    const double way = v * (r.t - std::sin(w * r.t) / w), speed = v * (1 - std::cos(w * r.t));
    EXPECT_NEAR(r.biases.at(0).value, 0.5 + way, 1e-6);
    EXPECT_NEAR(r.biases.at(0).force, 200 * (v * r.t - way), 1e-3);
    EXPECT_NEAR(*r.steering_work, 0.5 * 20 * speed * speed + 0.5 * 200 * std::pow(v * r.t - way, 2), 1e-5);
    EXPECT_FALSE(r.steering_force);
    EXPECT_NEAR(r.but_for_heat(), 0, 1e-6);
  });
}

// Four loose molecules in a box, under a bias of each kind, one of which moves.
const std::string kFourBiases =
    R"(place = [{molecule = "chain", count = 8, within_nm = [1, 1, 1, 2.6, 2.6, 2.6]}]
bias = [{name = "apart", variable = "distance", groups = [[0, 1, 2], "12-23"], rate_nm_ps = 0.02, k_kj_mol_nm2 = 500},
  {variable = "angle", groups = ["0-5", "6-11", "12-17"], at_least_deg = 70, at_most_deg = 100, k_kj_mol_rad2 = 80},
  {variable = "torsion", groups = [0, 2, 3, 5], at_deg = 170, k_kj_mol_rad2 = 5},
  {name = "size", variable = "gyration", groups = ["24-29"], at_most_nm = 0.3, k_kj_mol_nm2 = 900},
  {variable = "distance", groups = [[-1], [-12]], along = [1, 0, 0], force_kj_mol_nm = 0.5}]
build = {box_nm = 4}
forcefield = {cutoff_nm = 1, switch_nm = 0.9}
run = {dt_fs = 1, steps = 2000, log_every = 100, temperature_k = 300, minimise = true}
[molecule.chain]
atoms = [{name = "A", mass_u = 12, sigma_nm = 0.3, epsilon_kj_mol = 0.5}, {name = "B", mass_u = 20, sigma_nm = 0.3, epsilon_kj_mol = 0.5}]
units = 3
bonds = [[0, 1, 0.25], [1, 2, 0.25]]
)";

TEST(Bias, KeepsTheEnergyLessTheWorkOfMovingWalls) {
  Simulation simulation(read(kFourBiases));
  double first = NAN, largest = 0;
  std::vector<Record> rows;
  simulation.run([&](const Record& r) {
    if (r.step == 0) first = r.but_for_heat();
    largest = std::max(largest, std::abs(r.but_for_heat() - first));
    rows.push_back(r);
  });
  EXPECT_LT(largest, 0.05);
  EXPECT_GT(std::abs(rows.back().biases[0].value - rows.front().biases[0].value), 0.02);
  EXPECT_GT(std::abs(*rows.back().steering_work), 0);
  EXPECT_GT(rows.back().biases[2].value, 170 - 180);  // in degrees, within half a turn of its centre
  const Energies energies = simulation.energies();
  EXPECT_TRUE(std::ranges::any_of(energies, [](const auto& e) { return e.first == "bias"; }));
}

TEST(Bias, GoesOnFromACheckpointToTheLastBit) {
  const Scene scene = read(kFourBiases, {"run.thermostat=langevin", "run.barostat=c-rescale"});
  const auto [end, of_second] = expect_to_go_on_from(scene, 730);
  EXPECT_EQ(*end.row.steering_work, *of_second.row.steering_work);
  for (int b = 0; b < 5; ++b) EXPECT_EQ(end.row.biases[b].value, of_second.row.biases[b].value);
  EXPECT_EQ(end.summary.biases[1].value.value, of_second.summary.biases[1].value.value);
}

TEST(Bias, ReadsGroupsBySpansIndicesAndNames) {
  const Scene scene = read(kFourBiases);
  const std::vector<Bias>& all = scene.terms.biases;
  ASSERT_EQ(all.size(), 5u);
  EXPECT_THAT(all[0].groups[0].atoms, testing::ElementsAre(0, 1, 2));
  EXPECT_NEAR(all[0].groups[0].share[1], 20.0 / 44, 1e-15);
  EXPECT_EQ(all[0].groups[1].atoms.size(), 12u);
  EXPECT_EQ(all[0].lower, value_of(all[0], scene.start.box, scene.start.x)) << "where the start has it";
  EXPECT_THAT(all[4].groups[0].atoms, testing::ElementsAre(47));
  EXPECT_THAT(all[4].groups[1].atoms, testing::ElementsAre(36));
  EXPECT_EQ(all[4].variable, Variable::kComponent);
  EXPECT_EQ(all[1].name, "1");
  EXPECT_NEAR(all[1].upper, 100 * kPi / 180, 1e-15);
  EXPECT_TRUE(scene.closed());
  const Scene by_name = read(kFourBiases, {"bias.0.groups=[\"A\", [1, \"3-5\"]]"});
  EXPECT_EQ(by_name.terms.biases[0].groups[0].atoms.size(), 24u);
  EXPECT_THAT(by_name.terms.biases[0].groups[1].atoms, testing::ElementsAre(1, 3, 4, 5));
  EXPECT_EQ(in_words(all[1]), "bias 1: angle of 6 and 6 and 6 atoms, between 70° and 100° by 80 kJ/mol/rad²");
}

// Two molecules of one group on both sides of the box's face have their centre at the face.
TEST(Bias, BringsTheMoleculesOfAGroupTogether) {
  const Scene scene = read(R"(molecule.bead = {atoms = [{name = "B", mass_u = 40}]}
place = [{molecule = "bead", centres_nm = [[0.1, 1, 1], [3.9, 1, 1], [1, 1, 1], [0.2, 3.9, 1]]}]
bias = [{variable = "distance", groups = [[0, 1], [2]], k_kj_mol_nm2 = 100},
  {variable = "gyration", groups = [[0, 3]], k_kj_mol_nm2 = 100}]
build = {box_nm = 4}
)");
  EXPECT_NEAR(scene.terms.biases[0].lower, 1, 1e-12);
  EXPECT_NEAR(scene.start.x(0, 1), -0.1, 1e-12);
  EXPECT_NEAR(scene.start.x(1, 3), -0.1, 1e-12);
  EXPECT_THAT(scene.notes, testing::Contains(HasSubstr("2 molecules of biases' groups moved")));
}

TEST(Bias, StopsWhereNearestImagesOfItsCentresChange) {
  const std::string text = SceneText{kPairOfBeads}
                               .with("[run]", "[build]\nbox_nm = 2\n[run]")
                               .with("at_nm = 0.5\nk_kj_mol_nm2 = 200", "force_kj_mol_nm = 100")
                               .text;
  Simulation simulation(read(text, {"run.steps=5000"}));
  EXPECT_THAT(error_message<SimulationFailure>([&] { simulation.run({}); }),
              testing::AllOf(HasSubstr("bias arm: two of its centres are "), HasSubstr("take a larger box")));
}

TEST(Bias, ANoteSaysThatTheStartGivesItNoDirection) {
  const std::string text =
      SceneText{kPairOfBeads}
          .with("friction_per_ps = 2\n", "")
          .with("[0.4, 0, 0.3]]", "[0.4, 0, 0.3], [0.8, 0, 0.6]]")
          .with("variable = \"distance\"\ngroups = [[0], [1]]\nat_nm = 0.5\nk_kj_mol_nm2",
                "variable = \"angle\"\ngroups = [0, 1, 2]\nat_deg = 90\nk_kj_mol_rad2")
          .text;
  const std::string said =
      "start: bias arm does not act: its angle has no direction where centres coincide or lie";
  const Scene scene = read(text, {"run.temperature_k=0", "run.thermostat=none", "run.steps=20"});
  EXPECT_THAT(scene.notes, testing::Contains(HasSubstr(said)));
  Simulation simulation(scene);
  const Summary summary = simulation.run({});
  EXPECT_THAT(summary.doubts, testing::Contains(HasSubstr("bias arm did not act in 3 of 3 rows")));
}

TEST(Bias, BadOnesAreRefusedByName) {
  const SceneText good{kPairOfBeads};
  const char *groups = "[[0], [1]]", *k = "k_kj_mol_nm2 = 200", *at = "at_nm = 0.5";
  expect_said(
      good, {{k, k, "no error"},
             {"\"distance\"", "\"distanse\"", "bias.0.variable: there is no \"distanse\""},
             {groups, "[[0], [2]]", "bias.0.groups[1]: there is no atom 2, only 0 to"},
             {groups, "[[0], [\"C\"]]", "groups[1]: no atom is called \"C\""},
             {groups, "[[0], [1.5]]", "groups[1]: expected whole numbers and words"},
             {groups, "[\"1-0\", 1]", "\"1-0\": expected a span"},
             {groups, "[\"0-9\", 1]", "there is no atom 0-9, only 0 to 1"},
             {groups, "[[0]]", "distance needs 2 groups of atoms"},
             {groups, "[[0], [0]]", "groups: group 1 has the atoms of an earlier one"},
             {groups, "[[0, 0], [1]]", "group 0 names atom 0 twice"},
             {groups, "[[], [1]]", "group 0 has no atom"},
             {"at_nm", "at_deg", "at_deg: has no effect"},
             {at, "at_nm = 0.5\nat_most_nm = 1", "at_nm: expected either this"},
             {k, "", "expected k_kj_mol_nm2 (a restraint or walls), or"},
             {k, "k_kj_mol_nm2 = -1", "k_kj_mol_nm2: expected more than"},
             {k, "force_kj_mol_nm = 1", "at_nm: has no effect"},
             {at, "at_nm = -0.5", "no value of distance reaches its walls"},
             {at, "at_least_nm = 2\nat_most_nm = 1", "lower wall lies above the"},
             {"\"arm\"", "\"my arm\"", "bias.0.name: expected letters, digits and _"},
             {at, "at_nm = 0.5\nalong = [0, 0, 0]", "along: expected a direction"},
             {at, "at_nm = 0.5\nkk = 1", "unknown key \"kk\" in [bias.0]"},
             {"mass_u = 40", "mass_u = 0", "its atoms are anchors (mass 0), which do not"},
             {"[run]",
              "[[bias]]\nname = \"arm\"\nvariable = \"gyration\"\ngroups = [[0, 1]]\nk_kj_mol_nm2 = 1\n[run]",
              "bias.1.name: a second bias is called \"arm\""}});
  expect_said_of(good.with("[run]", "[build]\nbox_nm = 2\n[run]").text,
                 {{{"bias.0.at_nm=1.2"}, "1.2 nm is too far, expected at most"},
                  {{"bias.0.along=[1, 1, 0]"}, "images of this box differ along"}});
  const SceneText torsion =
      good.with("[0.4, 0, 0.3]]", "[0.4, 0, 0.3], [0, 1, 0], [1, 1, 1]]")
          .with("variable = \"distance\"\ngroups = [[0], [1]]\nat_nm = 0.5\nk_kj_mol_nm2 = 200",
                "variable = \"torsion\"\ngroups = [0, 1, 2, 3]\n@");
  expect_said(torsion, {{"@", "at_least_deg = 170\nat_most_deg = 190\nk_kj_mol_rad2 = 3", "no error"},
                        {"@", "at_most_deg = 190\nk_kj_mol_rad2 = 3", "a torsion goes round"},
                        {"@", "torque_kj_mol_rad = 3", "a constant torque has no energy that fits a"},
                        {"@", "at_deg = 9\nk_kj_mol_rad2 = 3\nalong = [0, 0, 1]", "along: has no effect"}});
}

}  // namespace
}  // namespace taut::bias_scenes_tests
