// Biases as OpenMM computes them, by CustomCentroidBondForce and CustomCVForce: energy, and forces, of its Reference
// platform.

#include <gmock/gmock.h>

#include "base/errors.hpp"
#include "openmm_parity.hpp"
#include "systems/openmm/export.hpp"

namespace taut::openmm_bias_tests {
namespace {

using tests::Folder;
using tests::Melt;

Bias bias_of(Bias::Variable variable, const System& sys) {
  Bias bias;
  bias.name = "b";
  bias.variable = variable;
  for (int g = 0; g < groups_of(variable); ++g) {
    std::vector<int> atoms;
    for (int a = 0; a <= g + 2; ++a) atoms.push_back(2 * Melt::kLength * g + a);
    bias.groups.push_back(make_group(sys, std::move(atoms)));
  }
  if (variable == Bias::Variable::kComponent) bias.along = Vec3(0, 0, -1);
  return bias;
}

// A bias that is written and read is the same.
void expect_same(const Bias& read, const Bias& written) {
  EXPECT_EQ(read.variable, written.variable);
  EXPECT_NEAR(read.k, written.k, 1e-12 * written.k);
  if (written.k > 0) {
    EXPECT_EQ(read.lower, written.lower);
    EXPECT_EQ(read.upper, written.upper);
  }
  EXPECT_NEAR(read.force, written.force, 1e-12 * std::abs(written.force));
  EXPECT_EQ(read.along, written.along);
  ASSERT_EQ(read.groups.size(), written.groups.size());
  for (std::size_t g = 0; g < read.groups.size(); ++g) {
    EXPECT_EQ(read.groups[g].atoms, written.groups[g].atoms);
    EXPECT_THAT(read.groups[g].share,
                testing::Pointwise(testing::DoubleNear(1e-15), written.groups[g].share));
  }
}

// Of a bias alone: what the melt's own forces are with it, less without it.
void expect_parity_of(const Bias& bias, OpenMMInput input) {
  const auto evaluated = [&](const Terms& terms) {
    State s = input.start;
    ForceField forces(input.system, s.box, terms);
    const double energy = forces.evaluate_energy(input.system, s);
    return std::pair(energy, s.f);
  };
  input.terms = {};
  input.terms.biases = {bias};
  const auto [energy, f] = evaluated(input.terms);
  EXPECT_GT(f.norm(), 0.1);
  const Folder folder;
  const std::string prefix = (folder.path() / "biased").string();
  write_openmm(input, prefix);
  const OpenMMTwin twin(prefix + ".system.xml", prefix + ".state.xml", {0.001});
  EXPECT_NEAR(twin.potential(), energy, 1e-9 * std::abs(energy)) << name_of(bias.variable);
  EXPECT_LT((twin.state().f - f).cwiseAbs().maxCoeff(), 1e-9 * f.cwiseAbs().maxCoeff())
      << name_of(bias.variable);
  const OpenMMInput again = read_openmm(prefix + ".system.xml", prefix + ".state.xml");
  ASSERT_EQ(again.terms.biases.size(), 1U);
  expect_same(again.terms.biases[0], bias);
}

TEST(OpenMMParity, BiasesOfEveryVariableAndLaw) {
  using Variable = Bias::Variable;
  constexpr double kInf = std::numeric_limits<double>::infinity();
  for (const int box : {0, 1, 2}) {
    Melt melt(30);
    if (box > 0) melt.make_periodic();
    if (box > 1) melt.skew();
    const Folder folder;
    const tests::Files files = melt.write(folder);
    const OpenMMInput input = read_openmm(files.system, files.state);
    ASSERT_EQ(input.start.box.periodic(), box > 0);
    for (const Bias::Variable variable : {Variable::kDistance, Variable::kComponent, Variable::kAngle,
                                          Variable::kTorsion, Variable::kGyration}) {
      Bias held = bias_of(variable, input.system);
      const double now = value_of(held, input.start.box, input.start.x);
      held.k = 200;
      held.lower = held.upper = now + (variable == Variable::kTorsion ? 3 : -0.1);
      expect_parity_of(held, input);
      Bias walls = held;
      walls.lower = now + 0.01, walls.upper = variable == Variable::kTorsion ? now + 2 : kInf;
      expect_parity_of(walls, input);
      if (variable == Variable::kTorsion) continue;
      Bias pull = bias_of(variable, input.system);
      pull.force = 30;
      expect_parity_of(pull, input);
    }
  }
}

TEST(OpenMMParity, MovingBiasesAreRefusedByName) {
  Melt melt(31);
  const Folder folder;
  const tests::Files files = melt.write(folder);
  OpenMMInput input = read_openmm(files.system, files.state);
  Bias bias = bias_of(Bias::Variable::kDistance, input.system);
  bias.k = bias.rate = 1;
  input.terms.biases = {bias};
  try {
    openmm_system_xml(input);
    FAIL() << "it was written";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("bias b moves, and OpenMM's forces do not depend on time"));
  }
}

}  // namespace
}  // namespace taut::openmm_bias_tests
