// Which energies are the same, and which only look alike.

#include "systems/openmm/known_energies.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "systems/openmm/formulas.hpp"

namespace taut::known_energies_tests {
namespace {

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

// Caps and tails of what is steep near and weak far away.
TEST(KnownEnergies, ReachFromTheNearToTheFar) {
  const KnownEnergy pair{"4*epsilon*((sigma/r)^12-(sigma/r)^6)", {{"epsilon"}, {"sigma"}}};
  const auto is_pair = [&](const char* text) {
    return recognize(Expression(text), {"eps", "sig"}, {{"r", 0}}, pair).has_value();
  };
  EXPECT_TRUE(is_pair("4*eps*(q*q-q);q=sig^6/r^6"));
  EXPECT_TRUE(is_pair("4*eps*sig^6*(sig^6-r^6)/r^12"));
  EXPECT_FALSE(is_pair("4*eps*((sig/r)^12-(sig/r)^6)*step(1.2-r)"));
  EXPECT_FALSE(is_pair("min(4*eps*((sig/r)^12-(sig/r)^6),1e5)"));
  EXPECT_FALSE(is_pair("4*eps*(1/(1e-6+(r/sig)^6)^2-1/(1e-6+(r/sig)^6))")) << "a soft core";
  const KnownEnergy walls{"0.5*k*max(abs(v-at)-wide,0)^2", {{"k"}, {"at"}, {"wide"}}, "wide"};
  EXPECT_FALSE(recognize(Expression("min(0.5*k*max(abs(v-at)-wide,0)^2,3000)"), {"k", "at", "wide"},
                         {{"v", 0}}, walls));
}

// A wall has no energy before it: there is no ratio of energies there, and the other must have none either.
TEST(KnownEnergies, AreNothingWhereTheyAreNothing) {
  const auto is_wall = [](const char* text) {
    const KnownEnergy wall{"0.5*k*max(r-r0,0)^2", {{"k"}, {"r0"}}};
    return recognize(Expression(text), {"k", "r0"}, {{"r", 0}}, wall).has_value();
  };
  EXPECT_TRUE(is_wall("0.5*k*step(r-r0)*(r-r0)^2"));
  EXPECT_TRUE(is_wall("k*(max(r,r0)-r0)^2"));
  EXPECT_FALSE(is_wall("0.5*k*max(r-r0,0)^2+0.1*k*step(r0-r)"));
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
}  // namespace taut::known_energies_tests
