// What the guess of λ misses, and the work that it does: the closed form of constraints/README.md.

#include "foretold.hpp"
#include "systems/openmm/import.hpp"
#include "systems/scene_file.hpp"

namespace taut::guess_tests {
namespace {

using tests::foretold;
using tests::Law;

// Of a motion that holds the bonds, y(u) = M⁻¹Jᵀu, in kJ/mol/ns/degree of freedom over h⁵ [ps].
struct Averages {
  double p = 0;  // ⟨λ̇·(v·y(λ̈))⟩
  double q = 0;  // ⟨λ̈·(v·y(λ̇))⟩
  double e = 0;  // ⟨λ̇·(a·y(λ̇))⟩
  Averages operator+(const Averages& o) const { return {p + o.p, q + o.q, e + o.e}; }
  double r() const { return -p - q; }
  double d() const { return r() - e; }
};

Averages averages_of(const Scene& scene, State* end = nullptr) {
  const System& sys = scene.system;
  const double h = scene.run.h();
  const int m = sys.bond_count();
  ForceField forces(sys, scene.start.box, scene.terms);
  Feedforward method(sys, {}, h);
  const Dynamics dynamics{sys, forces, method};
  State s = scene.start, at = s;
  initialize(dynamics, h, s);
  Eigen::VectorXd one = method.lambda(), two = one;
  Vectors r(3, m), v_ij(3, m), a_ij(3, m), y_ij(3, m), y(3, sys.atoms());
  const auto sum = [&](const Eigen::VectorXd& left, const Vectors& w, const Eigen::VectorXd& right) {
    y.setZero();
    add_constraint_acceleration(sys, r, right, y);
    differences(sys, y, y_ij);
    return left.dot(w.cwiseProduct(y_ij).colwise().sum().transpose());
  };
  Averages all;
  const double per = 2000 / (static_cast<double>(scene.run.steps) * degrees_of_freedom(sys, m, 3).total());
  for (long n = 0; n < scene.run.steps; ++n) {
    at = s;
    EXPECT_TRUE(step(dynamics, h, s).converged());
    const Eigen::VectorXd rate = (method.lambda() - two) / (2 * h),
                          second = (method.lambda() - 2 * one + two) / (h * h);
    two = one;
    one = method.lambda();
    const double w = per * tests::weight_of(n, scene.run.steps);
    differences(sys, at.x, r);
    differences(sys, at.v, v_ij);
    differences(sys, at.f * sys.inv_mass.asDiagonal(), a_ij);
    all.p += w * sum(rate, v_ij, second);
    all.q += w * sum(second, v_ij, rate);
    all.e += w * sum(rate, a_ij, rate);
  }
  if (end) *end = s;
  return all;
}

// λ* − λ = m₁ hλ̇ + m₂ h²λ̈ + …
struct Misses {
  explicit Misses(const Guess& g) {
    const double one = 1 + g.first, two = g.second - g.first, three = -g.second;
    first = -(one + 2 * two + 3 * three);
    second = 0.5 * (one + 4 * two + 9 * three);
  }
  double first, second;
};

double closed_form(const Averages& of, const Law& law, double h) {
  const Misses m(*law.guess);
  const double lag = 2 * law.ah / law.bh_squared, discrete = law.damping == Damping::kDiscrete ? 0.5 : 0;
  return (1 + law.ah) * std::pow(h, 5) / law.bh_squared *
         (m.second * of.p + m.first * (lag * of.q + discrete * of.e));
}

Scene scene_named(const char* name, const char* dt, const char* steps) {
  return read_scene(scenes_folder() / (std::string(name) + ".toml"), {dt, steps});
}

// There and back: what is odd under time reversal would average out in longer runs.
TEST(Guess, WhatItMissesDoesWorkByThreeAveragesOfTheMotion) {
  std::vector<Law> laws;
  for (const Damping damping : {Damping::kDiscrete, Damping::kCentred})
    for (const Guess& guess : {Guess{0, 0}, kThird, Guess{1, 0}}) laws.push_back({0.3, 2.5, guess, damping});
  for (const auto& [name, dt, steps] : {std::tuple("freely_jointed", "run.dt_fs=5", "run.steps=3000"),
                                        {"water", "run.dt_fs=0.5", "run.steps=5000"}}) {
    const Scene there = scene_named(name, dt, steps);
    Scene back = there;
    const Averages on_the_way_there = averages_of(there, &back.start);
    back.start.v *= -1;
    const Averages of = on_the_way_there + averages_of(back);
    const Eigen::VectorXd work = foretold(there, laws) + foretold(back, laws);
    const double h = there.run.h(), scale = closed_form(of, laws.back(), h);
    for (std::size_t l = 0; l < laws.size(); ++l)
      EXPECT_NEAR(work(static_cast<int>(l)) / scale, closed_form(of, laws[l], h) / scale, 0.07)
          << name << " " << name_of(laws[l].damping) << " " << laws[l].guess->first;
  }
}

// λ₁ cools and 2λ₁ − λ₂ heats; of a third only the lag of the damping is left.
TEST(Guess, OfAThirdDoesLittleWorkUnderCentredDamping) {
  const Scene water = scene_named("water", "run.dt_fs=1", "run.steps=2000");
  const auto of = [](const Guess& guess) { return Law{0.1, 2, guess, Damping::kCentred}; };
  const Eigen::VectorXd work = foretold(water, {of({0, 0}), of({1, 0}), of(kThird)});
  EXPECT_LT(work(0), 0);
  EXPECT_GT(work(1), 0);
  EXPECT_LT(std::abs(work(2)), 0.25 * std::min(-work(0), work(1)));
}

// The m₂/m₁ that does no work: 2αh/(βh)² + D/2P − (½ − 2αh/(βh)²) R/P in the discrete law. Where angles
// between bonds are rigid R is nothing. Tolerances are 3.5 to 4 times the scatter over twelve seeds.
TEST(Guess, NoWeightsThatMissServeEveryCluster) {
  const auto ratio = [](const Averages& of) { return 0.24 + of.d() / of.p / 2 - 0.26 * of.r() / of.p; };
  const Averages chain = averages_of(scene_named("freely_jointed", "run.dt_fs=10", "run.steps=2000")),
                 water = averages_of(scene_named("water", "run.dt_fs=1", "run.steps=6000")),
                 decane = averages_of(scene_named("decane", "run.dt_fs=1", "run.steps=4000"));
  const std::string data = std::string(TAUT_TEST_DATA) + "/dna-hbonds.";
  Scene hydrogens = import_openmm(data + "system.xml", data + "state.xml");
  apply_overrides(hydrogens, {"run.dt_fs=1", "run.steps=800", "run.seed=1", "run.velocities=draw",
                              "run.temperature_k=300"});
  const Averages dna = averages_of(hydrogens);
  EXPECT_NEAR(ratio(dna), -15.6, 8);
  for (const Averages& of : {chain, water, decane, dna}) EXPECT_GT(of.d(), 0);
  EXPECT_LT(std::abs(water.r() / water.p), 0.01);
  EXPECT_NEAR(chain.r() / chain.p, -1.9, 0.3);
  EXPECT_NEAR(ratio(chain), -1.5, 0.22);
  EXPECT_NEAR(ratio(water), -2.26, 0.5);
  EXPECT_NEAR(ratio(decane), -2.9, 0.6);
}

}  // namespace
}  // namespace taut::guess_tests
