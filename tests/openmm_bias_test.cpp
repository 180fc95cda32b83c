// Biases as OpenMM computes them, by CustomCentroidBondForce and CustomCVForce: energy, and forces, of its Reference
// platform.

#include <gmock/gmock.h>

#include "base/errors.hpp"
#include "error_message.hpp"
#include "openmm_parity.hpp"
#include "systems/openmm/export.hpp"

namespace taut::openmm_bias_tests {
namespace {

using tests::expect_parity;
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

// A force on centres of the groups of bias_of(), with three parameters that all may name.
OpenMM::CustomCentroidBondForce* centres(const std::string& energy, int groups, std::array<double, 3> p) {
  auto* force = new OpenMM::CustomCentroidBondForce(groups, energy);
  std::vector<int> of;
  for (int g = 0; g < groups; ++g) {
    std::vector<int> atoms;
    for (int a = 0; a <= g + 2; ++a) atoms.push_back(2 * Melt::kLength * g + a);
    std::vector<double> weights(atoms.size(), 0.5);
    weights.back() = 2;
    of.push_back(force->addGroup(atoms, g == 1 ? weights : std::vector<double>()));
  }
  std::vector<double> each;
  for (const auto& [name, value] : {std::pair("p", p[0]), std::pair("q", p[1]), std::pair("w", p[2])})
    if (energy.find(name) != energy.npos) force->addPerBondParameter(name), each.push_back(value);
  force->addBond(of, each);
  return force;
}

std::string refusal_of(OpenMM::Force* force) {
  Melt melt(32);
  melt.system.addForce(force);
  const Folder folder;
  const tests::Files files = melt.write(folder);
  return error_message([&] { (void)read_openmm(files.system, files.state); });
}

struct UsersLaw {
  const char* energy;
  int groups;
  std::array<double, 3> numbers;
};
// Each acts in the melt: distances of its centres are 0.5 to 2 nm.
const std::vector<UsersLaw> kUsersLaws = {
    {"0.5*p*(distance(g1,g2)-q)^2", 2, {300, 0.4, 0}},
    {"p*(distance(g2,g1)-q)^2", 2, {300, 0.4, 0}},
    {"700*(distance(g1,g2)-q)^2", 2, {0, 0.3, 0}},
    {"0.5*p*(distance(g1,g2)-0.4)^2", 2, {300, 0, 0}},
    {"step(d-0.1)*300*(d-0.1)^2; d=distance(g1,g2)", 2, {0, 0, 0}},
    {"150*(angle(g3,g2,g1)-0.4)^2", 3, {0, 0, 0}},
    {"15*min(d,2*pi-d)^2; d=abs(dihedral(g1,g2,g3,g4)-(-2.5)); pi=3.141592653589793", 4, {0, 0, 0}},
    {"step(d-q)*(p/2)*(d-q)^2; d=distance(g1,g2)", 2, {300, 0.1, 0}},
    {"0.5*p*max(0,q-distance(g1,g2))^2", 2, {300, 3, 0}},
    {"p*(max(0,q-d)^2+max(0,d-w)^2); d=distance(g1,g2)", 2, {300, 0.05, 0.1}},
    {"p*(max(0,q-d)^2+max(0,d-w)^2); d=distance(g1,g2)", 2, {300, 4, 5}},
    {"p*max(0,abs(distance(g1,g2)-q)-w)^2", 2, {300, 0.3, 0.1}},
    {"p*max(0,abs(distance(g1,g2)-q)-w)^2", 2, {300, 4, 0.1}},
    {"-p*distance(g1,g2)", 2, {40, 0, 0}},
    {"40*distance(g1,g2)", 3, {0, 0, 0}},
    {"0.5*p*(angle(g3,g2,g1)-q)^2", 3, {300, 0.4, 0}},
    {"0.5*p*min(d,2*pi-d)^2; d=abs(dihedral(g1,g2,g3,g4)-q); pi=3.141592653589793", 4, {30, -3, 0}},
    {"0.5*p*min(d,2*pi-d)^2; d=abs(dihedral(g4,g3,g2,g1)-q); pi=3.141592653589793", 4, {30, 3, 0}}};

TEST(OpenMMParity, BiasesThatUsersWrite) {
  for (const auto& [energy, groups, numbers] : kUsersLaws)
    for (const bool within : {false, true}) {
      SCOPED_TRACE(energy);
      Melt melt(33);
      if (!within) {
        melt.system.addForce(centres(energy, groups, numbers));
      } else {  // a CustomCVForce of the same variable
        const std::string text = energy;
        const auto at = text.find(groups == 4                        ? "dihedral("
                                  : text.find("angle(") != text.npos ? "angle("
                                                                     : "distance(");
        const std::string call = text.substr(at, text.find(')', at) + 1 - at);
        auto* force = new OpenMM::CustomCVForce(text.substr(0, at) + "cv" + text.substr(at + call.size()));
        force->addCollectiveVariable("cv", centres(call, groups, {}));
        int k = 0;
        for (const char* name : {"p", "q", "w"}) force->addGlobalParameter(name, numbers[k++]);
        melt.system.addForce(force);
      }
      const Folder folder;
      const tests::Files files = melt.write(folder);
      OpenMMInput input = read_openmm(files.system, files.state);
      ASSERT_EQ(input.terms.biases.size(), 1U);
      EXPECT_EQ(input.terms.biases[0].name, within ? "cv" : "0");
      BiasForces forces;
      Vectors f = Vectors::Zero(3, input.system.atoms());
      add_biases(input.terms.biases, input.start, f, forces);
      EXPECT_GT(f.norm(), 1) << "it does not act";
      tests::expect_parity(files);
    }
}

TEST(OpenMMParity, VariablesOfSingleAtoms) {
  Melt melt(34);
  const auto add = [&](OpenMM::Force* variable, double at) {
    auto* force = new OpenMM::CustomCVForce("0.5*k*min(d,6.283185307179586-d)^2; d=abs(cv-at)");
    force->addCollectiveVariable("cv", variable);
    force->addGlobalParameter("k", 90);
    force->addGlobalParameter("at", at);
    melt.system.addForce(force);
  };
  auto* torsion = new OpenMM::CustomTorsionForce("theta");
  torsion->addTorsion(0, 9, 17, 30, {});
  add(torsion, -2.5);
  auto* angle = new OpenMM::CustomAngleForce("theta");
  angle->addAngle(0, 9, 30, {});
  auto* distance = new OpenMM::CustomBondForce("r");
  distance->addBond(1, 40, {});
  for (OpenMM::Force* variable : std::vector<OpenMM::Force*>{angle, distance}) {
    auto* force = new OpenMM::CustomCVForce("0.5*k*(x1-to)^2");
    force->addCollectiveVariable("x1", variable);
    force->addGlobalParameter("k", 90);
    force->addGlobalParameter("to", 0.5);
    melt.system.addForce(force);
  }
  expect_parity(melt.write(Folder()));
}

TEST(OpenMMParity, BiasesThatTautHasNotAreRefusedWithARemedy) {
  const auto refused = [](const std::string& energy, int groups) {
    return refusal_of(centres(energy, groups, {1, 1, 1}));
  };
  const auto has_remedy = testing::HasSubstr("biases=[taut.Distance(...)]");
  for (const auto& [energy, groups] :
       {std::pair("p*distance(g1,g2)^3", 2), std::pair("p*((x1-q)^2+y1^2+z1^2)", 1),
        std::pair("p*(distance(g1,g3)-q)^2", 3), std::pair("p*(distance(g1,g2)+angle(g1,g2,g3)-q)^2", 3),
        std::pair("p*(dihedral(g1,g2,g3,g4)-q)^2", 4)})
    EXPECT_THAT(refused(energy, groups), testing::AllOf(testing::HasSubstr(energy), has_remedy));
  EXPECT_THAT(refused("-p*(distance(g1,g2)-q)^2", 2), testing::HasSubstr("a k below 0"));
  EXPECT_THAT(refused("-dihedral(g1,g2,g3,g4)", 4), testing::HasSubstr("no energy that fits a full turn"));
  auto* two = new OpenMM::CustomCVForce("a+b");
  two->addCollectiveVariable("a", centres("distance(g1,g2)", 2, {}));
  two->addCollectiveVariable("b", centres("angle(g1,g2,g3)", 3, {}));
  EXPECT_THAT(refusal_of(two), testing::HasSubstr("has 2 collective variables"));
  auto* scaled = new OpenMM::CustomCVForce("-a");
  scaled->addCollectiveVariable("a", centres("2*distance(g1,g2)", 2, {}));
  EXPECT_THAT(refusal_of(scaled), testing::HasSubstr("expected the energy distance(g1,g2)"));
}

TEST(OpenMMParity, GroupsBrokenAcrossTheBoxAreRefused) {
  for (const bool images : {false, true}) {
    Melt melt(35);
    melt.make_periodic();
    auto* force = centres("-p*distance(g1,g2)", 2, {40, 0, 0});
    force->setUsesPeriodicBoundaryConditions(images);
    melt.system.addForce(force);
    const Folder whole;
    if (images) expect_parity(melt.write(whole));
    melt.break_across_box();
    const Folder folder;
    const tests::Files files = melt.write(folder);
    EXPECT_THROW((void)read_openmm(files.system, files.state), InputError) << images;
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
  EXPECT_THAT(error_message([&] { openmm_system_xml(input); }),
              testing::HasSubstr("bias b moves, and OpenMM's forces do not depend on time"));
}

}  // namespace
}  // namespace taut::openmm_bias_tests
