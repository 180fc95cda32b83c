// Energies as OpenMM's custom forces write them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "error_message.hpp"
#include "systems/openmm/expression.hpp"
#include "systems/openmm/formulas.hpp"
#include "systems/openmm/known_energies.hpp"

namespace taut::openmm_expression_tests {
namespace {

double value(const std::string& text, const Expression::Values& values = {}) {
  return Expression(text)(values);
}

TEST(Expression, IsArithmetic) {
  EXPECT_EQ(value("1+2*3"), 7);
  EXPECT_EQ(value("8-4-2"), 2);
  EXPECT_EQ(value("8/4/2"), 1);
  EXPECT_EQ(value("2^3^2"), 512);
  EXPECT_EQ(value("-2^2"), -4);
  EXPECT_EQ(value("2^-1"), 0.5);
  EXPECT_EQ(value("2*-3"), -6);
  EXPECT_EQ(value(" ( 1 + 2 ) * .5e1 "), 15);
  EXPECT_EQ(value("- -3"), 3);
}

TEST(Expression, HasOpenMMsFunctions) {
  EXPECT_EQ(value("min(2,1)+max(3,4)+abs(-1)+square(3)+cube(2)+recip(4)"), 1 + 4 + 1 + 9 + 8 + 0.25);
  EXPECT_EQ(value("step(0)+step(-1)+delta(0)+delta(1)+select(1,5,6)+select(0,5,6)"), 1 + 1 + 5 + 6);
  EXPECT_EQ(value("floor(1.5)+ceil(1.5)"), 3);
  EXPECT_EQ(
      value("sqrt(x)+exp(x)+log(x)+erf(x)+erfc(x)+atan2(x,2)", {{"x", 0.7}}),
      std::sqrt(0.7) + std::exp(0.7) + std::log(0.7) + std::erf(0.7) + std::erfc(0.7) + std::atan2(0.7, 2));
}

TEST(Expression, DefinesWhatComesBefore) {
  EXPECT_EQ(value("a*b; a=b+1; b=x; ", {{"x", 3}}), 12);
  EXPECT_THAT(Expression("k*(r-r0)^2;r0=0.5*(a1+a2)").names(), ::testing::ElementsAre("a1", "a2", "k", "r"));
  EXPECT_THAT(Expression("a;a=a+1").names(), ::testing::ElementsAre("a")) << "the later a is another";
}

TEST(Expression, CallsTables) {
  const Expression::Tables tables = {
      {"f", {2, [](std::span<const double> at) { return 10 * at[0] + at[1]; }}}};
  EXPECT_EQ(Expression("f(type1, 3)/2", tables)({{"type1", 4}}), 21.5);
}

TEST(Expression, MeansPiByItsFirstDigits) {
  EXPECT_EQ(value("3.14159"), std::acos(-1));
  EXPECT_EQ(value("6.283185"), 2 * std::acos(-1));
  EXPECT_EQ(value("3.1415"), 3.1415);
}

// What a value is uncertain by, if each operation is right to ten digits, and which way a branch went.
TEST(Expression, SaysHowSureItIs) {
  const auto probe = [](const char* text, double x) {
    Expression::Ways ways;
    const auto found = Expression(text).probe({{"x", x}}, ways);
    return std::pair(found, ways);
  };
  EXPECT_NEAR(probe("(x+1e6)-1e6", 1).first.error, 1e-4, 2e-5) << "what is cancelled";
  EXPECT_NEAR(probe("x^12", 10).first.error, 1e-10 * 1e12, 1e-11 * 1e12);
  EXPECT_THAT(probe("step(x-2)+max(x,3)", 1).second, ::testing::ElementsAre(0, 0));
  EXPECT_THAT(probe("step(x-2)+max(x,3)", 4).second, ::testing::ElementsAre(1, 1));
  EXPECT_FALSE(probe("step(x-2*1)", 2 + 1e-11).first.decided());
  EXPECT_TRUE(probe("max(x*1,2)", 2).first.decided()) << "it is the same to both sides";
  EXPECT_FALSE(probe("floor(x*1)", 3 - 1e-11).first.decided());
  EXPECT_FALSE(probe("sqrt(x*3-3)", 1 - 1e-11).first.decided()) << "at the edge of where it has a value";
}

TEST(Expression, SaysWhatIsWrong) {
  const auto complaint = [](const std::string& text) {
    return error_message<Expression::Error>([&] { Expression expression(text); });
  };
  EXPECT_EQ(complaint("1+"), "expected a name, found \"\"");
  EXPECT_EQ(complaint("(1+2"), "expected ), found \"\"");
  EXPECT_EQ(complaint("1 2"), "expected an operator, found \"2\"");
  EXPECT_EQ(complaint("f(1)"), "calls f, which is no function of it");
  EXPECT_EQ(complaint("sqrt(1,2)"), "calls sqrt of 1 arguments with 2");
  EXPECT_EQ(complaint("a;b;"), "expected =, found \"\"");
  EXPECT_EQ(complaint("a;b=1;b=2"), "defines b twice");
  EXPECT_EQ(complaint(""), "expected a name, found \"\"");
  EXPECT_EQ(complaint(std::string(500, '(')), "is nested too deep");
  EXPECT_EQ(complaint("1" + std::string(5000, '+')), "is too long");
  std::string growing = "a0";
  for (int k = 0; k < 60; ++k)
    growing += ";a" + std::to_string(k) + "=a" + std::to_string(k + 1) + "+a" + std::to_string(k + 1);
  EXPECT_EQ(complaint(growing), "is too long") << "2^60 terms";
}

using std::numbers::pi;

const KnownEnergy kSpring = {"0.5*k*(r-r0)^2", {{"k"}, {"r0"}}};
const KnownEnergy kTorsion = {kTorsionEnergy, {{"k"}, {"theta0", -pi, pi}}};

std::optional<Recognized> spring(const std::string& text, const std::vector<std::string>& declared) {
  return recognize(Expression(text), declared, {{"r", 0}}, kSpring);
}
std::optional<Recognized> torsion(const std::string& text) {
  return recognize(Expression(text), {"k", "theta0"}, {{"theta", -pi, pi}}, kTorsion);
}

TEST(KnownEnergies, AreKnownByTheirAlgebra) {
  for (const char* text :
       {"0.5*k*(r-r0)^2", "k*square(r0-r)/2", "0.5*k*(r*r-2*r*r0+r0*r0)", "c*d*d;d=r-r0;c=k*0.5",
        "k*max(r-r0,r0-r)^2/2", "k*select(step(r-r0),r-r0,r0-r)^2/2"}) {
    const auto found = spring(text, {"k", "r0"});
    ASSERT_TRUE(found) << text;
    EXPECT_NEAR(found->factor, 1, 1e-14);
    EXPECT_EQ(found->name_of.at("k"), "k");
  }
  EXPECT_EQ(spring("0.5*k*(r-r0)^2", {"k", "r0"})->factor, 1) << "exactly";
  EXPECT_NEAR(spring("k*(r-r0)^2", {"k", "r0"})->factor, 2, 1e-14);
  EXPECT_NEAR(spring("-k*(r-r0)^2", {"k", "r0"})->factor, -2, 1e-14);
  const auto renamed = spring("stiff*(r-rest)^2", {"rest", "stiff"});
  ASSERT_TRUE(renamed);
  EXPECT_EQ(renamed->name_of.at("k"), "stiff");
  EXPECT_EQ(renamed->name_of.at("r0"), "rest");
  const auto swapped = spring("r0*(r-k)^2", {"k", "r0"});
  ASSERT_TRUE(swapped) << "names do not count";
  EXPECT_EQ(swapped->name_of.at("k"), "r0");
}

// A number may stand where taut has a parameter: equal numbers for one, or each for its own.
TEST(KnownEnergies, HaveNumbersForParameters) {
  const auto at = [](const char* text, Expression::Numbers named) -> std::string {
    const KnownEnergy spring{"0.5*k*(v-at)^2", {{"k"}, {"at"}}};
    const auto found = recognize(Expression(text, {}, named), {"k"}, {{"v"}}, spring);
    return found ? found->name_of.at("at") : "";
  };
  using Numbers = Expression::Numbers;
  EXPECT_EQ(at("k/2*(v-0.3)^2", Numbers::kNamedAlike), "0.3");
  EXPECT_EQ(at("k/2*(v-0.3)^2", Numbers::kFixed), "");
  EXPECT_EQ(at("k/2*(v-0.3)*(v-0.3)", Numbers::kNamedAlike), "0.3");
  EXPECT_EQ(at("k/2*(v-0.3)*(v-0.3)", Numbers::kNamedApart), "");
  EXPECT_EQ(at("0.5*k*(v-0.5)^2", Numbers::kNamedAlike), "");
  EXPECT_EQ(at("0.5*k*(v-0.5)^2", Numbers::kNamedApart), "0.5@1");
  EXPECT_EQ(at("k*(v-(-0.3))^2", Numbers::kNamedAlike), "-0.3");
  EXPECT_EQ(Expression("-2^2", {}, Numbers::kNamedAlike)({{"2", 2.0}, {"-2", -2.0}}), -4);
}

TEST(KnownEnergies, AreNotWhatLooksLikeThem) {
  for (const char* text :
       {"0.5*k*(r+r0)^2", "0.5*k*(r-r0)^4", "0.5*k*(r-r0)^2+1", "0.5*k*(r-r0)^2.001", "k", "0*k*r0*r",
        "0.5*k*(r-r0)^2+1e-3*r", "0.5*k*(r-1.001*r0)^2", "log(-k*r0*r)",
        // the same up to a turn, or but for a narrow piece
        "0.5*k*(r-r0)^2*step(4-r)", "0.5*k*min(r-r0,3.5)^2", "0.5*k*(r-abs(r0))^2",
        "select(step(r-r0-3),k*3*(r-r0-1.5),0.5*k*(r-r0)^2)", "0.5*k*(r-r0)^2+step(r-7)*step(7.1-r)",
        "0.5*k*(r-r0)^2+step(r-7*r0)*step(7.1*r0-r)", "0.5*k*(r-r0)^2+1e-6*k*(r-r0)^4",
        "0.5*k*(r-r0)^2/(1+(r/5)^200)", "0.5*k*(r-r0)^2*(1+tanh(1000*(4-r)))/2",
        "0.5*k*(r-r0)^2+exp(-((r-5.5)/0.001)^2)", "0.5*k*(r-r0)^2+exp(-((r-2*r0)/0.001)^2)",
        "0.5*k*(r-floor(r/50)*50-r0)^2",
        // a branch that goes one way alone
        "0.5*k*(r-r0)^2*step(r)", "0.5*k*(r-r0)^2*select(delta(r-3),2,1)"})
    EXPECT_FALSE(spring(text, {"k", "r0"})) << text;
  EXPECT_FALSE(spring("0.5*k*(r-1)^2", {"k"}));
  const KnownEnergy growth{"k*r", {{"k"}}};
  EXPECT_FALSE(
      recognize(Expression("2*r*type1", {}, Expression::Numbers::kNamedAlike), {}, {{"r", 0}}, growth))
      << "has a value at no point";
}

// Where an energy has no value, the other has none either; beyond a condition they may differ.
TEST(KnownEnergies, AreComparedWhereTheyCount) {
  const KnownEnergy fene{kFeneEnergy, {{"k"}, {"r0"}}};
  const auto is_fene = [&](const char* text) {
    return recognize(Expression(text), {"k", "r0"}, {{"r", 0}}, fene).has_value();
  };
  EXPECT_TRUE(is_fene("-k*r0*r0/2*(log(1-r/r0)+log(1+r/r0))"));
  EXPECT_FALSE(is_fene("-0.5*k*r0^2*log(max(1-(r/r0)^2,1e-6))")) << "goes on beyond r0";
  const KnownEnergy beads{kWcaEnergy, {{"sigma"}, {"epsilon"}}, "1.122462048309373*sigma-r"};
  const auto is_beads = [&](const std::string& text) {
    return recognize(Expression(text), {"sigma", "epsilon"}, {{"r", 0}}, beads).has_value();
  };
  EXPECT_TRUE(is_beads("2*u-u;u=" + std::string(kWcaEnergy)));
  EXPECT_FALSE(is_beads("step(1.1*sigma-r)*u;u=" + std::string(kWcaEnergy)));
  EXPECT_FALSE(is_beads("min(100,u);u=" + std::string(kWcaEnergy)));
}

// As openmm.app writes it for the force fields of CHARMM, Amber and GROMACS.
TEST(KnownEnergies, HaveEverySpellingOfTheHarmonicImproper) {
  for (const char* text :
       {"k*min(dtheta, 2*pi-dtheta)^2; dtheta = abs(theta-theta0);pi = 3.141593;",
        "k*min(dtheta, 2*pi-dtheta)^2; dtheta = abs(theta-theta0);pi = 3.141592;",
        "k*min(dtheta, 2*3.141592653589793-dtheta)^2; dtheta = abs(theta-theta0)",
        "k*dtheta_torus^2; dtheta_torus = dtheta - floor(dtheta/(2*pi)+0.5)*(2*pi); dtheta = theta - theta0; "
        "pi = 3.14159265359",
        "k*(thetap-theta0)^2; thetap = step(-(theta-theta0+pi))*2*pi+theta+step(theta-theta0-pi)*(-2*pi); "
        "pi = 3.14159265358979"}) {
    const auto found = torsion(text);
    ASSERT_TRUE(found) << text;
    EXPECT_NEAR(found->factor, 2, 1e-13) << text;
  }
  EXPECT_FALSE(torsion("k*(theta-theta0)^2")) << "it jumps";
  EXPECT_FALSE(torsion("k*min(d,6-d)^2;d=abs(theta-theta0)"));
}

}  // namespace
}  // namespace taut::openmm_expression_tests
