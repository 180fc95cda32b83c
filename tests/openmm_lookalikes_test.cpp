// Every custom energy that is recognized: rewritten in ways that leave it the same it is still taken, and what only
// resembles it is refused by name, with its formula.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "forcefield/force_field.hpp"
#include "openmm_texts.hpp"

namespace taut::openmm_lookalikes_tests {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// A force of one term, with parameters of it. `turn` is a value that its coordinate may have.
struct Force {
  const char *type, *energy, *coordinate;
  double turn;
  std::vector<std::pair<const char*, double>> parameters;
};
void PrintTo(const Force& force, std::ostream* out) {
  for (const char* c = force.energy; *c; ++c)
    *out << (std::isalnum(static_cast<unsigned char>(*c)) ? *c : '_');
}

// The lists of each type of force, but for its parameters.
struct Shape {
  const char *type, *version, *attributes, *parameters, *terms;
};
constexpr std::array kShapes = {
    Shape{"CustomBondForce", "3", "usesPeriodic=\"0\"", "PerBondParameters",
          "<Bonds><Bond p1=\"0\" p2=\"1\" #/></Bonds>"},
    Shape{"CustomAngleForce", "3", "usesPeriodic=\"0\"", "PerAngleParameters",
          "<Angles><Angle p1=\"0\" p2=\"1\" p3=\"2\" #/></Angles>"},
    Shape{"CustomTorsionForce", "3", "usesPeriodic=\"0\"", "PerTorsionParameters",
          "<Torsions><Torsion p1=\"0\" p2=\"1\" p3=\"2\" p4=\"3\" #/></Torsions>"},
    Shape{"CustomExternalForce", "1", "", "PerParticleParameters",
          "<Particles><Particle index=\"2\" #/></Particles>"},
    Shape{
        "CustomNonbondedForce", "3",
        "cutoff=\"1\" method=\"0\" switchingDistance=\"-1\" useLongRangeCorrection=\"0\" "
        "useSwitchingFunction=\"0\"",
        "PerParticleParameters",
        "<Particles><Particle #/><Particle #/><Particle #/><Particle #/></Particles><Exclusions/><Functions/>"
        "<InteractionGroups/>"},
    Shape{"CustomCompoundBondForce", "3", "particles=\"2\" usesPeriodic=\"0\"", "PerBondParameters",
          "<Bonds><Bond p1=\"0\" p2=\"1\" #/></Bonds><Functions><Function max=\"3\" min=\"0\" name=\"table\" "
          "type=\"Continuous1DFunction\" version=\"1\"><Values><Value v=\"5\"/><Value v=\"-2\"/><Value "
          "v=\"1\"/>"
          "<Value v=\"4\"/><Value v=\"0\"/></Values></Function></Functions>"},
    Shape{"CustomCentroidBondForce", "3", "groups=\"4\" usesPeriodic=\"0\"", "PerBondParameters",
          "<Groups><Group><Particle p=\"0\"/></Group><Group><Particle p=\"1\"/></Group><Group><Particle "
          "p=\"2\"/></Group>"
          "<Group><Particle p=\"3\"/></Group></Groups><Bonds><Bond g1=\"0\" g2=\"1\" g3=\"2\" g4=\"3\" "
          "#/></Bonds>"
          "<Functions/>"}};

std::string with(std::string text, const std::string& from, const std::string& to) {
  for (auto at = text.find(from); at != text.npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

Texts texts_of(const Force& force, const std::string& energy) {
  const Shape& shape = *std::ranges::find(kShapes, std::string_view(force.type), &Shape::type);
  std::string declared, values;
  int count = 0;
  for (const auto& [name, value] : force.parameters) {
    declared += "<Parameter name=\"" + std::string(name) + "\"/>";
    values += "param" + std::to_string(++count) + "=\"" + std::to_string(value) + "\" ";
  }
  Texts texts;
  texts.system =
      "<System type=\"System\" version=\"1\"><PeriodicBoxVectors><A x=\"9\" y=\"0\" z=\"0\"/><B x=\"0\" "
      "y=\"9\" "
      "z=\"0\"/><C x=\"0\" y=\"0\" z=\"9\"/></PeriodicBoxVectors><Particles><Particle mass=\"5\"/><Particle "
      "mass=\"6\"/><Particle mass=\"7\"/><Particle mass=\"8\"/></Particles><Constraints/><Forces><Force "
      "energy=\"" +
      energy + "\" forceGroup=\"0\" name=\"tie\" type=\"" + shape.type + "\" version=\"" + shape.version +
      "\" " + shape.attributes + "><" + shape.parameters + ">" + declared + "</" + shape.parameters +
      "><GlobalParameters/>" +
      (force.type == std::string("CustomExternalForce") ? "" : "<EnergyParameterDerivatives/>") +
      with(shape.terms, "#", values) + "</Force></Forces></System>";
  texts.state =
      "<State time=\"0\" type=\"State\" version=\"1\"><Positions><Position x=\"0.1\" y=\"0.2\" "
      "z=\"0.3\"/><Position "
      "x=\"0.5\" y=\"0.1\" z=\"0.4\"/><Position x=\"0.8\" y=\"0.6\" z=\"0.5\"/><Position x=\"1.3\" y=\"0.7\" "
      "z=\"1.1\"/></Positions></State>";
  return texts;
}

// The energy and the forces of what is read.
Eigen::VectorXd forces_of(const Texts& texts) {
  OpenMMInput input = read(texts);
  ForceField field(input.system, input.start.box, input.terms);
  Eigen::VectorXd all(1 + input.start.x.size());
  all[0] = field.evaluate_energy(input.system, input.start);
  all.tail(input.start.x.size()) = input.start.f.reshaped();
  return all;
}

class CustomEnergies : public ::testing::TestWithParam<Force> {};

TEST_P(CustomEnergies, AreTakenHoweverTheyAreWritten) {
  const Force& force = GetParam();
  const Eigen::VectorXd expected = forces_of(texts_of(force, force.energy));
  EXPECT_GT(expected.tail(12).norm(), 0);
  const std::string turn = std::to_string(force.turn);
  for (const std::string& rewritten :
       std::vector<std::string>{"2*w/2", "w*3-w-w", "-(0-w)", "w*(sin(V)^2+cos(V)^2)",
                                "select(step(V-" + turn + "),w,w*2-w)", "w*log(exp(1))"}) {
    const std::string energy = with(rewritten, "V", force.coordinate) + ";w=" + force.energy;
    try {
      const Eigen::VectorXd found = forces_of(texts_of(force, energy));
      EXPECT_LT((found - expected).norm(), 1e-9 * expected.norm()) << energy;
    } catch (const InputError& e) {
      ADD_FAILURE() << energy << ": " << e.what();
    }
  }
}

TEST_P(CustomEnergies, AreRefusedWhereTheyOnlyResembleOne) {
  const Force& force = GetParam();
  const std::string turn = std::to_string(force.turn);
  for (const std::string& other :
       std::vector<std::string>{"w*step(T-V)", "select(step(V-T),0,w)", "w+step(V-T)*(V-T)^2", "min(w,3000)",
                                "max(w,-3000)+step(w-3000)*w", "w+1e-6*V^4", "w+step(V-T)*step(1.001*T-V)",
                                "w+exp(-((V-T)/0.0001)^2)", "w*(1-tanh(1e4*(V-T)))", "w*step(V+2e9)",
                                "w*erfc(1000*(V-T))", "w*(1+1e-7*V)"}) {
    const std::string energy = with(with(other, "T", turn), "V", force.coordinate) + ";w=" + force.energy;
    EXPECT_THAT(refusal(texts_of(force, energy)),
                AllOf(one_line_with(std::string(force.type) + " \"tie\": "), HasSubstr(energy)));
  }
}

const char* kSeparation = "distance(g1,g2)";
INSTANTIATE_TEST_SUITE_P(
    Known, CustomEnergies,
    ::testing::Values(
        Force{"CustomBondForce", "0.5*k*(r-r0)^2", "r", 7, {{"k", 300}, {"r0", 0.4}}},
        Force{"CustomBondForce", "-0.5*k*r0^2*log(1-(r/r0)^2)", "r", 0.3, {{"k", 300}, {"r0", 0.7}}},
        Force{"CustomAngleForce", "0.5*k*(theta-theta0)^2", "theta", 2.9, {{"k", 30}, {"theta0", 1.8}}},
        Force{"CustomAngleForce", "k*(1+cos(theta))", "theta", 2.9, {{"k", 30}}},
        Force{"CustomAngleForce",
              "0.5*k*(cos(theta)-cos(theta0))^2",
              "theta",
              2.9,
              {{"k", 30}, {"theta0", 1.8}}},
        Force{"CustomTorsionForce",
              "k*min(d,2*pi-d)^2;d=abs(theta-theta0);pi=3.141593",
              "theta",
              2.9,
              {{"k", 30}, {"theta0", 0.8}}},
        Force{"CustomExternalForce", "-q*E*z", "z", 7, {{"q", 3}, {"E", 2}}},
        Force{"CustomExternalForce", "-(fx*x+fy*y+fz*z)", "x", 7, {{"fx", 3}, {"fy", 2}, {"fz", 1}}},
        Force{"CustomExternalForce",
              "0.5*k*((x-x0)^2+(y-y0)^2+(z-z0)^2)",
              "y",
              7,
              {{"k", 30}, {"x0", 0.7}, {"y0", 0.9}, {"z0", 0.1}}},
        Force{"CustomExternalForce",
              "k*periodicdistance(x,y,z,x0,y0,z0)^2",
              "y",
              7,
              {{"k", 30}, {"x0", 0.7}, {"y0", 0.9}, {"z0", 0.1}}},
        Force{"CustomExternalForce", "0.5*k*(z-z0)^2", "z", 7, {{"k", 30}, {"z0", 0.2}}},
        Force{"CustomExternalForce",
              "k*max(0,sqrt((x-x0)^2+(y-y0)^2)-w)^2",
              "x",
              7,
              {{"k", 30}, {"x0", 0.2}, {"y0", 0.1}, {"w", 0.3}}},
        Force{"CustomExternalForce", "k*step(z-z0)*(z-z0)^2", "z", 7, {{"k", 30}, {"z0", 0.2}}},
        Force{"CustomNonbondedForce",
              "4*sqrt(e1*e2)*((s/r)^12-(s/r)^6);s=0.5*(s1+s2)",
              "r",
              0.2,
              {{"s", 0.3}, {"e", 2}}},
        Force{"CustomCompoundBondForce", "k*table(distance(p1,p2))", "distance(p1,p2)", 2, {{"k", 3}}},
        Force{"CustomCentroidBondForce",
              "0.5*k*(distance(g1,g2)-r0)^2",
              kSeparation,
              7,
              {{"k", 300}, {"r0", 0.2}}},
        Force{"CustomCentroidBondForce",
              "0.5*k*max(distance(g1,g2)-r0,0)^2",
              kSeparation,
              7,
              {{"k", 300}, {"r0", 0.2}}},
        Force{"CustomCentroidBondForce",
              "0.5*k*max(abs(distance(g1,g2)-r0)-w,0)^2",
              kSeparation,
              7,
              {{"k", 300}, {"r0", 0.2}, {"w", 0.1}}},
        Force{"CustomCentroidBondForce", "-F*distance(g1,g2)", kSeparation, 7, {{"F", 30}}},
        Force{"CustomCentroidBondForce",
              "0.5*k*(angle(g1,g2,g3)-a)^2",
              "angle(g1,g2,g3)",
              2.9,
              {{"k", 30}, {"a", 1}}},
        Force{"CustomCentroidBondForce",
              "k*min(d,2*pi-d)^2;d=abs(dihedral(g1,g2,g3,g4)-phi);pi=3.14159265358979",
              "dihedral(g1,g2,g3,g4)",
              2.9,
              {{"k", 30}, {"phi", 1}}}));

}  // namespace
}  // namespace taut::openmm_lookalikes_tests
