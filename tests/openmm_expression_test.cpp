// Energies as OpenMM's custom forces write them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "error_message.hpp"
#include "systems/openmm/expression.hpp"

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

}  // namespace
}  // namespace taut::openmm_expression_tests
