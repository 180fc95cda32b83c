// What is in OpenMM's XML that taut does not carry out, or no serializer ever wrote, is refused in one line.

#include <fmt/format.h>

#include <array>

#include "openmm_texts.hpp"

namespace taut::openmm_refusals_tests {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// What ctest calls a case: its complaint, of characters that ctest takes.
void print_words(const char* complaint, std::ostream* out) {
  for (const char* c = complaint; *c; ++c) *out << (std::isalnum(static_cast<unsigned char>(*c)) ? *c : ' ');
}

struct Change {
  const char *from, *to, *complaint;
};
void PrintTo(const Change& change, std::ostream* out) {
  print_words(change.complaint, out);
}
class Refuses : public ::testing::TestWithParam<Change> {};

TEST_P(Refuses, ByNameAndLine) {
  const auto& [from, to, complaint] = GetParam();
  EXPECT_THAT(refusal(from, to),
              AllOf(one_line_with(complaint), ::testing::ContainsRegex("a\\.(system|state)\\.xml:[0-9]+: ")));
}

INSTANTIATE_TEST_SUITE_P(
    WhatIsNotCarriedOut, Refuses,
    ::testing::Values(
        Change{"k*min(dtheta, 2*pi-dtheta)^2", "k*min(dtheta, pi-dtheta)^2",
               "force 11: CustomTorsionForce \"impropers\": has the energy k*min(dtheta, pi-dtheta)^2"},
        Change{
            "k*min(dtheta, 2*pi-dtheta)^2; dtheta = abs(theta-theta0)", "k*(theta-theta0)^2",
            "force 11: CustomTorsionForce \"impropers\": jumps where theta goes from pi to -pi, as theta0 is "
            "2.75"},
        Change{"k*min(dtheta, 2*pi-dtheta)^2", "k*min(dtheta 2*pi-dtheta)^2", "expected ), found \"2*pi"},
        Change{"param2=\"2.75\"", "param2=\"3.75\"", "has theta0 = 3.75, expected from -3.14159 to 3.14159"},
        Change{"bend*(theta-rest)^2", "bend*(theta-rest)^4",
               "force 12: CustomAngleForce: has the energy bend*"},
        // alike where one looks, and something else beyond
        Change{"stiff*(r-d)^2", "stiff/r^12-1.001*d/r^6", "has the energy stiff/r^12"},
        Change{"4*epsilon*((sigma/r)^12-(sigma/r)^6)+epsilon",
               "(4*epsilon*((sigma/r)^12-(sigma/r)^6)+epsilon)*step(sigma-r)",
               "force 8: CustomNonbondedForce: has the energy"},
        Change{"stiff*(r-d)^2", "stiff*(r-d)^2+wall", "does not declare wall, which its energy names"},
        Change{"4*epsilon*((sigma/r)^12-(sigma/r)^6)+epsilon", "epsilon*exp(-r/sigma)",
               "force 8: CustomNonbondedForce: has the energy epsilon*exp(-r/sigma): taut knows"},
        Change{"4*epsilon*((sigma/r)^12-(sigma/r)^6)+epsilon",
               "4*epsilon*(select(step(r-0.4),((sigma/r)^6-1)^2,(sigma/r)^12-(sigma/r)^6))",
               "to switch Lennard-Jones off give the force a switchingDistance"},
        Change{"4*epsilon*((sigma/r)^12-(sigma/r)^6)+epsilon", "4*epsilon*((sigma/r)^12-(sigma/r)^6)",
               "force 8: CustomNonbondedForce: adds to the Lennard-Jones of a NonbondedForce"},
        Change{"method=\"2\" name=\"NonbondedForce\"", "method=\"5\" name=\"NonbondedForce\"",
               "force 4: NonbondedForce: uses LJPME: taut has"},
        Change{"method=\"2\" name=\"NonbondedForce\"", "method=\"1\" name=\"NonbondedForce\"",
               "force 4: NonbondedForce: its pairs are not periodic, but force 0: HarmonicBondForce "
               "\"stretch\" is"},
        Change{"method=\"2\" name=\"CustomNonbondedForce\"", "method=\"1\" name=\"CustomNonbondedForce\"",
               "force 8: CustomNonbondedForce: its pairs are not periodic"},
        Change{"method=\"2\" name=\"CustomNonbondedForce\"", "method=\"0\" name=\"CustomNonbondedForce\"",
               "force 8: CustomNonbondedForce: is not cut off"},
        Change{"includeDirectSpace=\"1\"", "includeDirectSpace=\"0\"", "leaves its direct space out"},
        Change{"useSwitchingFunction=\"0\"", "useSwitchingFunction=\"1\"",
               "force 8: CustomNonbondedForce: has useSwitchingFunction"},
        Change{"useLongRangeCorrection=\"0\"", "useLongRangeCorrection=\"1\"", "has useLongRangeCorrection"},
        Change{"<ParticleOffsets/>",
               "<ParticleOffsets><Offset eps=\"0\" parameter=\"s\" particle=\"0\" q=\"1\" "
               "sig=\"0\"/></ParticleOffsets>",
               "(ParticleOffsets): taut has fixed parameters"},
        Change{"<ExceptionOffsets/>",
               "<ExceptionOffsets><Offset eps=\"0\" parameter=\"s\" exception=\"0\" q=\"1\" "
               "sig=\"0\"/></ExceptionOffsets>",
               "(ExceptionOffsets): taut has fixed parameters"},
        Change{"<GlobalParameters/>",
               "<GlobalParameters><Parameter default=\"1\" name=\"s\"/></GlobalParameters>",
               "(GlobalParameters): taut has fixed parameters"},
        Change{"<EnergyParameterDerivatives/>",
               "<EnergyParameterDerivatives><Parameter name=\"k\"/></EnergyParameterDerivatives>",
               "force 5: CustomBondForce \"springs\": has EnergyParameterDerivatives: taut carries out none"},
        Change{"<ComputedValues/>", "<ComputedValues><Value expression=\"1\" name=\"c\"/></ComputedValues>",
               "has ComputedValues"},
        Change{"<Functions/>", "<Functions><Function name=\"f\"/></Functions>", "Function lacks type"},
        Change{"<Functions/>",
               "<Functions><Function max=\"2\" min=\"0\" name=\"f\" periodic=\"1\" "
               "type=\"Continuous1DFunction\" version=\"2\"/></Functions>",
               "has the periodic function f: taut's tables are not"},
        Change{"<InteractionGroups/>",
               "<InteractionGroups><InteractionGroup><Set1><Particle index=\"0\"/></Set1><Set2><Particle "
               "index=\"1\"/></Set2></InteractionGroup></InteractionGroups>",
               "has pairs of some groups alone; taut takes one group, of atoms with themselves"},
        Change{"type=\"RBTorsionForce\"", "type=\"AmoebaTorsionForce\"",
               "force 3: AmoebaTorsionForce \"RBTorsionForce\": is not one taut knows"},
        Change{"type=\"RBTorsionForce\"", "type=\"MonteCarloMembraneBarostat\"",
               "is a barostat taut has not: take it out, and say run.barostat = \"c-rescale\""},
        Change{"-mass*(gx*x+gy*y+gz*z)", "-mass*(gx*x^2+gy*y+gz*z)",
               "has the energy -mass*(gx*x^2+gy*y+gz*z): taut knows forces that are the same at all places"},
        Change{"<C x=\"0\" y=\"0\" z=\"3\"/>", "<C x=\"0\" y=\"9\" z=\"3\"/>",
               "a.state.xml:3: its box has cy = 9 nm, expected at most half of by"},
        Change{"gx=\"-1.25\"", "gx=\"-1.25\" lambda=\"1\"",
               "a.state.xml:8: the State sets the parameter lambda, which no force"}));

// The last atom, which is anchored, made a virtual site.
struct Site {
  const char *element, *complaint;
};
void PrintTo(const Site& site, std::ostream* out) {
  print_words(site.complaint, out);
}
class RefusesSite : public ::testing::TestWithParam<Site> {};

TEST_P(RefusesSite, ByNameAndLine) {
  const auto& [element, complaint] = GetParam();
  const std::string particle = std::string("<Particle mass=\"0\">") + element + "</Particle>";
  EXPECT_THAT(refusal("<Particle mass=\"0\"/>", particle),
              AllOf(one_line_with(complaint), ::testing::ContainsRegex("a\\.(system|state)\\.xml:[0-9]+: ")));
}

INSTANTIATE_TEST_SUITE_P(
    ThatCannotBe, RefusesSite,
    ::testing::Values(
        Site{"<SymmetrySite p=\"0\"/>",
             "atom 11 is a virtual site of a kind taut does not know: it has TwoParticleAverageSite, Three"},
        Site{"<TwoParticleAverageSite p1=\"1\" p2=\"2\" w1=\".5\" w2=\".5\"/><OutOfPlaneSite/>",
             "Particle has an element OutOfPlaneSite"},
        Site{"<TwoParticleAverageSite p1=\"1\" p2=\"2\" w1=\".5\"/>", "TwoParticleAverageSite lacks w2"},
        Site{"<TwoParticleAverageSite p1=\"1\" p2=\"12\" w1=\".5\" w2=\".5\"/>", "has p2=\"12\", expected"},
        Site{"<TwoParticleAverageSite p1=\"1\" p2=\"11\" w1=\".5\" w2=\".5\"/>",
             "atom 11: its virtual site follows from itself"},
        Site{"<TwoParticleAverageSite p1=\"1\" p2=\"2\" w1=\".5\" w2=\".6\"/>", "weights that add to 1.1"},
        Site{"<LocalCoordinatesSite pos1=\"0\" pos2=\"0\" pos3=\"1\"/>", "has no parents"},
        Site{"<LocalCoordinatesSite pos1=\"0\" pos2=\"0\" pos3=\"1\" p1=\"1\" wo1=\"1\" wx1=\"0\" "
             "wy1=\"0\"/>",
             "(the first is atom 1) are in line or in one place"}));

INSTANTIATE_TEST_SUITE_P(
    WhatDoesNotFit, Refuses,
    ::testing::Values(
        Change{"<Parameter default=\"4000\" name=\"k\"/>", "<Parameter default=\"4000\" name=\"K\"/>",
               "does not declare k, which its energy names"},
        Change{"<Parameter default=\"4000\" name=\"k\"/>", "<Parameter default=\"4000\" name=\"r\"/>",
               "declares r, which is a coordinate"},
        Change{"<Parameter default=\"3\" name=\"fy\"/>",
               "<Parameter default=\"3\" name=\"fy\"/><Parameter default=\"2\" name=\"gx\"/>",
               "global parameter gx is 2 by default, but 0.5 in another force"},
        Change{"name=\"RBTorsionForce\" type=\"RBTorsionForce\" usesPeriodic=\"0\" version=\"2\"",
               "name=\"RBTorsionForce\" type=\"RBTorsionForce\" usesPeriodic=\"0\" version=\"3\"",
               "has version=\"3\", expected 2"},
        Change{"type=\"System\" version=\"1\"", "type=\"System\" version=\"2\"",
               "a.system.xml:2: has version=\"2\""},
        Change{"map=\"1\"", "map=\"2\"", "force 10: CMAPTorsionForce: cmap 1: map 2, there are 2"},
        Change{"<Map size=\"2\">", "<Map size=\"3\">", "has 4 energies, expected 3 x 3"},
        Change{"a2=\"1\"", "a2=\"12\"", "force 10: CMAPTorsionForce: Torsion has a2=\"12\""},
        Change{"<Energy e=\"-4.7166\"/>", "<Energy/>", "Energy lacks e"},
        Change{"periodicity=\"2\"", "periodicity=\"0\"", "expected an integer from 1 to 64"},
        Change{"usesPeriodic=\"1\"", "usesPeriodic=\"2\"", "expected 0 or 1"},
        Change{" frequency=\"25\"", "", "Force lacks frequency"},
        Change{" forceGroup=\"0\"", " forceGroup=\"0\" strength=\"2\"",
               "has strength=\"2\", which taut does not know"},
        Change{"<Angles>", "<Rings/><Angles>", "has an element Rings, which taut does not know"},
        Change{"<Angles>", "<Angles/><Angles>", "has a second Angles"},
        Change{"<Bond d=", "<Bond p1=\"0\" d=", "Bond has p1 twice"},
        Change{"<Position x=\".2421\"", "<Position x=\"nan\"",
               "a.state.xml:11: Position has x=\"nan\", expected a number"},
        Change{"<Position x=\".2421\"", "<Position x=\"&amp;\"", "Position has x=\"&\""},
        Change{"<Positions>", "<Positions><Position x=\"0\" y=\"0\" z=\"0\"/>",
               "has 13 positions, but the system has 12 atoms"},
        Change{"<Velocities>", "<Velocities><Velocity x=\"0\" y=\"0\" z=\"0\"/>", "has 13 velocities"},
        Change{"<Particle mass=", "<Particle mass=\"-1\"/><Particle mass=", "atom 0 has mass -1"},
        Change{"<Particle eps=", "<Particle eps=\"0\" q=\"0\" sig=\"0\"/><Particle eps=",
               "has 13 particles, the system has 12 atoms"},
        Change{"index=\"8\"", "index=\"12\"", "Particle has index=\"12\", expected an integer from 0 to 11"},
        Change{"sig=\"1\"", "sig=\"-1\"", "force 4: NonbondedForce: exception 0: sigma -1"},
        Change{"cutoff=\"1.2\"", "cutoff=\"1.6\"", "cutoff 1.6 nm is over half the box"},
        Change{"switchingDistance=\".9\"", "switchingDistance=\"1.2\"", "switch at 1.2 nm"},
        Change{"<Constraints>", "text<Constraints>", "a.system.xml:22: not whole XML: the text \"text"},
        Change{"</System>", "</System>more", "not whole XML: the text \"more"}));

// Forces of the State's own and of the wrong kind of pair.
TEST(OpenMMReader, RefusesTwoOfWhatThereIsOneOf) {
  for (const char* type : {"NonbondedForce", "CustomNonbondedForce", "CMMotionRemover"}) {
    Texts texts = every_force();
    const auto named = texts.system.find(std::string("type=\"") + type);
    const auto from = texts.system.rfind("<Force ", named);
    const bool leaf = std::string(type) == "CMMotionRemover";
    const auto to = leaf ? texts.system.find("/>", from) + 2 : texts.system.find("</Force>", from) + 8;
    texts.system.insert(texts.system.find("</Forces>"), texts.system.substr(from, to - from));
    EXPECT_THAT(refusal(texts),
                one_line_with(std::string("force 15: ") + type + ": is the second of its kind"))
        << type;
  }
}

// A uniform field pulls each atom by its own force. It is gravity where it pulls each mass once, all by one acceleration.
TEST(OpenMMReader, TakesGravityThatIsNotUniformAsPulls) {
  const std::size_t pulls = read(every_force()).terms.pulls.size();
  EXPECT_TRUE(read(every_force()).terms.gravity);
  Texts texts = every_force();
  const auto at = texts.system.find("<Particle index=\"0\"");
  const std::string last = texts.system.substr(at, texts.system.find("/>", at) + 2 - at);
  const auto with = [&](const std::string& instead) {
    Texts changed = every_force();
    changed.system.replace(at, last.size(), instead);
    return read(changed).terms;
  };
  const std::size_t atoms = 11;  // the twelfth has no mass
  EXPECT_EQ(with("").pulls.size(), pulls + atoms - 1);
  EXPECT_EQ(with(last + last).pulls.size(), pulls + atoms + 1);
  const Terms heavier = with("<Particle index=\"0\" param1=\"100\"/>");
  EXPECT_EQ(heavier.pulls.size(), pulls + atoms);
  EXPECT_FALSE(heavier.gravity);
}

// A water whose atoms' distances are these, and a System that holds them so and so.
Texts one_water(double scale, const std::array<double, 3>& lengths) {
  Texts texts;
  texts.system =
      "<System type=\"System\" version=\"1\"><PeriodicBoxVectors><A x=\"2\" y=\"0\" z=\"0\"/><B x=\"0\" "
      "y=\"2\" z=\"0\"/><C x=\"0\" y=\"0\" z=\"2\"/></PeriodicBoxVectors><Particles><Particle "
      "mass=\"16\"/><Particle mass=\"1\"/><Particle mass=\"1\"/></Particles><Constraints>";
  constexpr std::array<std::array<int, 2>, 3> kPairs = {{{0, 1}, {0, 2}, {1, 2}}};
  for (std::size_t b = 0; b < 3; ++b)
    texts.system +=
        fmt::format("<Constraint d=\"{}\" p1=\"{}\" p2=\"{}\"/>", lengths[b], kPairs[b][0], kPairs[b][1]);
  texts.system += "</Constraints><Forces/></System>";
  texts.state = fmt::format(
      "<State time=\"0\" type=\"State\" version=\"1\"><Positions><Position x=\"0\" y=\"0\" "
      "z=\"0\"/><Position "
      "x=\"{}\" y=\"0\" z=\"0\"/><Position x=\"{}\" y=\"{}\" z=\"0\"/></Positions></State>",
      0.0957 * scale, -0.024 * scale, 0.0927 * scale);
  return texts;
}

TEST(OpenMMReader, AsksWhetherPositionsAreInAngstrom) {
  const std::array lengths = {0.0957, 0.0957, 0.1514};
  EXPECT_EQ(refusal(one_water(1, lengths)), "no error");
  EXPECT_THAT(
      refusal(one_water(10, lengths)),
      one_line_with("a.state.xml:1: ", "atoms 0 and 1 are 0.957 nm apart, and their bond is 0.0957 nm long",
                    "are the positions in ångström?"));
  EXPECT_EQ(refusal(one_water(5, lengths)), "no error") << "brought to the bonds";
}

TEST(OpenMMReader, RefusesLengthsThatCloseNoTriangle) {
  EXPECT_THAT(refusal(one_water(1, {0.2, 0.2, 0.5})),
              one_line_with("a.system.xml:1: ",
                            "bond 2 (1-2): lengths 0.2, 0.2 and 0.5 nm close no triangle (1-0-2)"));
  EXPECT_THAT(refusal(one_water(1, {0.2, 0.5, 0.2})),
              one_line_with("bond 1 (0-2): lengths 0.2, 0.2 and 0.5 nm"));
  for (const double across : {0.4, 0.4001})  // in line; a bond too many, which the start judges
    EXPECT_EQ(refusal(one_water(1, {0.2, 0.2, across})), "no error");
}

// Pairs of Lennard-Jones are those a NonbondedForce leaves to them.
TEST(OpenMMReader, RefusesASecondLennardJonesOfAPair) {
  Texts texts = every_force();
  replace(texts.system, "stiff*(r-d)^2", "4*stiff*((d/r)^12-(d/r)^6)");
  EXPECT_THAT(refusal(texts), HasSubstr("no error"));  // 0-2 is excluded
  Texts other = texts;
  replace(other.system, "<Bond p1=\"0\" p2=\"2\" param1=\"1250\"", "<Bond p1=\"0\" p2=\"9\" param1=\"1250\"");
  replace(other.system, "type=\"CustomBondForce\" usesPeriodic=\"1\"",
          "type=\"CustomBondForce\" usesPeriodic=\"0\"");
  EXPECT_THAT(refusal(other),
              one_line_with("force 13: CustomBondForce \"UreyBradley\": has the pair 0-9, which is no "
                            "exception of a NonbondedForce"));
  replace(texts.system, "<Bond p1=\"0\" p2=\"2\" param1=\"1250\" param2=\".2375\"/>",
          "<Bond p1=\"0\" p2=\"2\" param1=\"1250\" param2=\".2375\"/><Bond p1=\"2\" p2=\"0\" param1=\"1\" "
          "param2=\".2\"/>");
  EXPECT_THAT(refusal(texts), one_line_with("has the pair 2-0, which has Lennard-Jones already"));
}

TEST(OpenMMReader, RefusesATermBetweenMolecules) {
  Texts texts = every_force();
  replace(texts.system, "<Angles>", "<Angles><Angle a=\"2\" k=\"1\" p1=\"0\" p2=\"1\" p3=\"2\"/>");
  EXPECT_THAT(refusal(texts), HasSubstr("no error"));
  replace(texts.system, "p1=\"0\" p2=\"1\" p3=\"2\"", "p1=\"0\" p2=\"1\" p3=\"8\"");
  EXPECT_THAT(refusal(texts),
              one_line_with("force 1: HarmonicAngleForce: angle 0 (0-1-8) joins two molecules"));
}

// Three atoms in line, 0.8 nm from one to the next, in a box of 2.4 nm: of 0 and 2, OpenMM takes the nearest
// image.
TEST(OpenMMReader, RefusesATermLongerThanHalfTheBox) {
  const auto vectors = [](const char* edge) {
    return "<PeriodicBoxVectors><A x=\"" + std::string(edge) + "\" y=\"0\" z=\"0\"/><B x=\"0\" y=\"" + edge +
           "\" z=\"0\"/><C x=\"0\" y=\"0\" z=\"" + edge + "\"/></PeriodicBoxVectors>";
  };
  const std::string angles =
      R"(<Force type="HarmonicAngleForce" usesPeriodic="1" version="2"><Angles>
         <Angle a="1" k="1" p1="0" p2="2" p3="1"/></Angles></Force>)";
  const auto system = [&](const char* edge) {
    return R"(<System type="System" version="1">)" + vectors(edge) +
           R"(<Particles><Particle mass="1"/><Particle mass="1"/><Particle mass="1"/></Particles>
         <Constraints><Constraint d=".8" p1="0" p2="1"/><Constraint d=".8" p1="1" p2="2"/></Constraints><Forces>)" +
           angles + "</Forces></System>";
  };
  const auto state = [&](const char* edge) {
    return R"(<State time="0" type="State" version="1">)" + (edge ? vectors(edge) : "") +
           R"(<Positions><Position x="0" y="0" z="0"/>
         <Position x=".8" y="0" z="0"/><Position x="1.6" y="0" z="0"/></Positions></State>)";
  };
  const char* const too_long = "angle 0 (0-2-1) is longer than half the box";
  EXPECT_THAT(refusal({system("1"), state("3.4")}), HasSubstr("no error"));
  EXPECT_THAT(refusal({system("3.4"), state("2.4")}), one_line_with(too_long));
  EXPECT_THAT(refusal({system("3.4"), state(nullptr)}), HasSubstr("no error"));
  EXPECT_THAT(refusal({system("2.4"), state(nullptr)}), one_line_with(too_long));
}

TEST(OpenMMReader, RefusesDeepNestingWithoutGoingDeep) {
  std::string open, close;
  for (int n = 0; n < 300'000; ++n) {
    open += "<a>";
    close += "</a>";
  }
  for (const char* at :
       {"<Constraints>", "<Angles>", "<IntegratorParameters version=\"1\"/>", "<Energies "}) {
    Texts texts = every_force();
    std::string& text = texts.system.find(at) != std::string::npos ? texts.system : texts.state;
    replace(text, at, open + close + at);
    EXPECT_THAT(refusal(texts), one_line_with("<a> is 33 elements deep")) << at;
  }
  EXPECT_THAT(refusal({open, every_force().state}), one_line_with("a.system.xml:1: not whole XML"));
}

TEST(OpenMMReader, ExpandsNoEntities) {
  Texts texts = every_force();
  replace(texts.system, "<System", "<!DOCTYPE s [<!ENTITY a \"1\"><!ENTITY b \"&a;&a;&a;&a;\">]>\n<System");
  replace(texts.system, "<Bond d=\"", "<Bond d=\"&b;");
  EXPECT_THAT(refusal(texts), one_line_with("Bond has d=\"&b;"));
}

TEST(OpenMMReader, RefusesWhatIsNoText) {
  Texts texts = every_force();
  texts.system[500] = '\0';
  EXPECT_THAT(refusal(texts), one_line_with("not whole XML: a character 0"));
  texts = every_force();
  const std::string half = texts.system.substr(0, texts.system.size() / 2);
  for (const auto& [system, words] : {std::pair(half, "not whole XML"),
                                      {"", "a.system.xml:1: not whole XML: there is no element"},
                                      {"<html/>", "expected an OpenMM System, found <html>"},
                                      {texts.state, "expected an OpenMM System, found a \"State\""}})
    EXPECT_THAT(refusal({system, texts.state}), one_line_with(words));
  for (const char* end : {"</Forces>", "</State>"}) {  // OpenMM's own reader takes these for whole
    const std::string cut = texts.state.substr(0, texts.state.find(end));
    EXPECT_THAT(refusal({texts.system, cut}), one_line_with("a.state.xml:", "not whole XML")) << end;
  }
  const auto from = texts.state.find("<Positions>"), to = texts.state.find("</Positions>") + 12;
  EXPECT_THAT(refusal({texts.system, texts.state.erase(from, to - from)}),
              one_line_with("a.state.xml", "no positions"));
}

TEST(OpenMMReader, SaysOneShortLineWhateverTheFileHolds) {
  const std::string message =
      refusal("name=\"springs\"", "name=\"a&#10;b\" odd=\"" + std::string(100'000, 'x') + "\"");
  EXPECT_THAT(message, one_line_with("force 5: CustomBondForce \"a b\": Force has odd=\"xxx"));
  EXPECT_LT(message.size(), 400u);
}

}  // namespace
}  // namespace taut::openmm_refusals_tests
