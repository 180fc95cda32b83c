// Coordinates of PDB and GRO files, as other programs write them.

#include "files/coordinate_file.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "error_message.hpp"
#include "files/frame.hpp"
#include "files/pdb_file.hpp"
#include "temporary_folder.hpp"

namespace taut::coordinate_file_tests {
namespace {

const std::string kPdb = R"(TITLE     two molecules
CRYST1   20.000   25.000   30.000  90.00  90.00  90.00 P 1           1
MODEL        1
ATOM      1  N   GLY A   1      11.000  -2.500   3.125  1.00  0.00           N
ATOM      2  CA AGLY A   1      12.000   0.000   0.000  1.00  0.00           C
ATOM      3  CA  ALA A   1A     13.000   0.000   0.000  1.00  0.00           C
HETATM    4 CL    CL B   7       1.000   1.000   1.000  1.00  0.00          CL
ENDMDL
MODEL        2
ATOM      1  N   GLY A   1      99.000   0.000   0.000  1.00  0.00           N
ENDMDL
)";

// As GROMACS's manual has it, two waters with velocities.
const std::string kGro = R"(MD of 2 waters, t= 0.0
    6
    1WATER  OW1    1   0.126   1.624   1.679  0.1227 -0.0580  0.0434
    1WATER  HW2    2   0.190   1.661   1.747  0.8085  0.3191 -0.7791
    1WATER  HW3    3   0.177   1.568   1.613 -0.9045 -2.6469  1.3180
    2WATER  OW1    4   1.275   0.053   0.622  0.2519  0.3140 -0.1734
    2WATER  HW2    5   1.337   0.002   0.680 -1.0641 -1.1349  0.0257
    2WATER  HW3    6   1.326   0.120   0.568  1.9427 -0.8216 -0.0244
   1.82060   1.82060   1.82060
)";

Coordinates read(const std::string& name, const std::string& text) {
  const TemporaryFolder folder;
  return read_coordinates(folder.write(name, text));
}

std::string complaint(const std::string& name, const std::string& text) {
  const TemporaryFolder folder;
  return folder.without_path(error_message([&] { read_coordinates(folder.write(name, text)); }));
}

std::string with(std::string text, const std::string& old, const std::string& changed) {
  EXPECT_NE(text.find(old), text.npos) << old;
  return text.replace(text.find(old), old.size(), changed);
}

TEST(CoordinateFile, Pdb) {
  const Coordinates all = read("a.pdb", kPdb);
  ASSERT_EQ(all.x.cols(), 4);
  EXPECT_EQ(all.v.cols(), 0);
  EXPECT_TRUE(all.x.col(0).isApprox(Vec3(1.1, -0.25, 0.3125), 1e-15));
  EXPECT_TRUE(all.box.edge.isApprox(Vec3(2, 2.5, 3), 1e-15));
  EXPECT_EQ(all.names.residue, (std::vector<int>{0, 0, 1, 2}));  // 1 and 1A are two
  const AtomKind& chloride = all.names.kinds[all.names.kind[3]];
  EXPECT_EQ(chloride.atom, "CL");
  EXPECT_EQ(chloride.residue, "CL");
  EXPECT_EQ(chloride.element, "Cl");
}

TEST(CoordinateFile, Gro) {
  const Coordinates all = read("a.gro", kGro);
  ASSERT_EQ(all.x.cols(), 6);
  EXPECT_EQ(all.x.col(4), Vec3(1.337, 0.002, 0.680));
  EXPECT_EQ(all.v.col(2), Vec3(-0.9045, -2.6469, 1.3180));
  EXPECT_EQ(all.box.edge, Vec3::Constant(1.8206));
  EXPECT_EQ(all.names.residue, (std::vector<int>{0, 0, 0, 1, 1, 1}));
  EXPECT_EQ(all.names.kinds[all.names.kind[5]].atom, "HW3");
  EXPECT_EQ(all.names.kinds[all.names.kind[5]].residue, "WATER");
}

TEST(CoordinateFile, GroOfMoreDecimalsAndASkewedBox) {
  const Coordinates all = read("a.gro",
                               "two\n 1\n    1ION     NA    1   0.12345   1.62456  -1.67900\n"
                               "  2.0 1.8 1.6  0 0  0.5 0  -0.25 0.75\n");
  EXPECT_EQ(all.x.col(0), Vec3(0.12345, 1.62456, -1.679));
  EXPECT_EQ(all.box.tilt, Vec3(0.5, -0.25, 0.75));
  EXPECT_EQ(all.v.cols(), 0);
}

// What taut writes it reads: a skewed box by its angles, too.
TEST(CoordinateFile, ReadsWhatIsWrittenForViewers) {
  const TemporaryFolder folder;
  State s;
  s.x = Vectors::Random(3, 3);
  s.box = {Vec3(4, 3.5, 3), Vec3(-1, 0.5, 1.25)};
  const System sys = make_system(Eigen::VectorXd::Ones(3), {});
  const Names names = repeated_names({{"OW", "HOH", "O"}, {"HW1", "HOH", "H"}, {"MW", "HOH", ""}}, 1);
  write_pdb(folder.path() / "s.pdb", {sys, names}, s);
  const Coordinates back = read_coordinates(folder.path() / "s.pdb");
  EXPECT_LT((back.x - s.x).cwiseAbs().maxCoeff(), 5.1e-5);
  EXPECT_LT((back.box.vectors() - s.box.vectors()).cwiseAbs().maxCoeff(), 5e-4);
  for (int a = 0; a < 3; ++a) {
    EXPECT_EQ(back.names.kinds[back.names.kind[a]].atom, names.kinds[names.kind[a]].atom);
    EXPECT_EQ(back.names.kinds[back.names.kind[a]].element, names.kinds[names.kind[a]].element);
  }
}

Coordinates read_box(const std::string& numbers) {
  return read("a.gro", "one\n 1\n    1ION     NA    1   0.123   1.624   1.679\n" + numbers + "\n");
}
Coordinates read_cell(const std::string& numbers) {
  return read("a.pdb", "CRYST1" + numbers + kPdb.substr(kPdb.find("\nMODEL")));
}

// How far the vectors are from those of the shape [nm].
double off(const Box& box, const Vec3& edge, const Vec3& tilt) {
  return std::max((box.edge - edge).cwiseAbs().maxCoeff(), (box.tilt - tilt).cwiseAbs().maxCoeff());
}

// Of every size: as many decimals as are asked for, by single precision as GROMACS computes them, in both
// orientations of the dodecahedron.
TEST(CoordinateFile, ShapesOfEverySizeAreBoxesAtTheDecimalsOfTheFile) {
  for (const int decimals : {3, 5, 6})
    for (int n = 0; n < 100; ++n) {
      const double a = 1 + 0.0493827 * n, third = std::sqrt(1.0 / 3), h = std::sqrt(3.0) / 2;
      const Box shapes[] = {
          {Vec3(1, 1, std::sqrt(0.5)), Vec3(0, 0.5, 0.5)},
          {Vec3(1, h, std::sqrt(2.0 / 3)), Vec3(0.5, 0.5, third / 2)},
          {Vec3(1, h, std::sqrt(2.0 / 3)), Vec3(-0.5, -0.5, third / 2)},
          {Vec3(1, std::sqrt(8.0) / 3, std::sqrt(6.0) / 3), Vec3(1, -1, std::sqrt(2.0)) / 3}};
      for (const Box& shape : shapes) {
        const Vec3 edge = a * shape.edge, tilt = a * shape.tilt;
        std::string text;
        for (const double x : {edge[0], edge[1], edge[2], 0.0, 0.0, tilt[0], 0.0, tilt[1], tilt[2]})
          text += fmt::format(" {:.{}f}", static_cast<float>(x), decimals);
        const Coordinates all = read_box(text);
        EXPECT_LT(off(all.box, edge, tilt), std::pow(10.0, -decimals)) << text;
        EXPECT_EQ(all.note, "") << text;
        for (int t = 0; t < 3; ++t)
          EXPECT_LE(std::abs(all.box.tilt[t]), (0.5 + 1e-6) * all.box.edge[t / 2]) << text;
      }
    }
}

// As gmx editconf and MDAnalysis write CRYST1: lengths of three decimals in Å, angles of two.
TEST(CoordinateFile, CellsOfThreeDecimals) {
  for (const auto& [numbers, a] : {std::pair("   31.235   31.235   31.235  60.00  60.00  90.00", 3.1235),
                                   {"  248.645  248.645  248.645  60.00  60.00  90.00", 24.8645}}) {
    const Coordinates all = read_cell(numbers);
    EXPECT_LT(off(all.box, a * Vec3(1, 1, std::sqrt(0.5)), a * Vec3(0, 0.5, 0.5)), 1e-12);
    EXPECT_THAT(all.note, testing::Not(testing::HasSubstr("reduced")));
  }
  for (const double a : {1.9732, 3.1235, 9.0621, 13.5065, 24.8645, 40.0001}) {
    const Coordinates all = read_cell(fmt::format("{0:9.3f}{0:9.3f}{0:9.3f}  70.53 109.47  70.53", 10 * a));
    const double b = std::sqrt(8.0) / 3;
    EXPECT_LT(off(all.box, a * Vec3(1, b, std::sqrt(6.0) / 3), a * Vec3(1, -1, b * 1.5) / 3), 1e-4 * a);
    EXPECT_THAT(all.note, testing::Not(testing::HasSubstr("reduced")));
    EXPECT_LE(all.box.tilt[2], (0.5 + 1e-6) * all.box.edge[1]);
  }
  EXPECT_LT(off(read_cell("   31.235   31.235   50.000  90.00  90.00 120.00").box,
                Vec3(3.1235, 3.1235 * std::sqrt(0.75), 5), Vec3(-1.56175, 0, 0)),
            1e-12);
}

// What is no rounding is taken off by whole vectors: the lattice is the same, and a line says so.
TEST(CoordinateFile, ReducesABoxByWholeVectors) {
  Coordinates all = read_box("2.0 1.8 1.6  0 0  1.5 0  2.25 1.55");  // b + a, c + b + a
  EXPECT_EQ(all.box.edge, Vec3(2, 1.8, 1.6));
  EXPECT_TRUE(all.box.tilt.isApprox(Vec3(-0.5, 0.75, -0.25), 1e-12)) << all.box.tilt.transpose();
  EXPECT_THAT(all.note, testing::EndsWith("a.gro: its box is reduced to bx = -0.5, cx = 0.75, cy = -0.25 nm "
                                          "(b - a, c - b, c - a), which leaves the lattice as it is"));
  all = read_box("2 2 2 0 0 2 0 -6 1");
  EXPECT_EQ(all.box.tilt, Vec3(0, 0, 1));
  EXPECT_THAT(all.note, testing::HasSubstr("(b - a, c + 3a)"));
  all = read_cell("   30.000   40.000   50.000  90.00 125.00  90.00");  // monoclinic, as MDAnalysis writes it
  EXPECT_TRUE(all.box.tilt.isApprox(Vec3(0, 0.1321178, 0), 1e-6)) << all.box.tilt.transpose();
  EXPECT_THAT(all.note, testing::HasSubstr("(c + a)"));
}

TEST(CoordinateFile, ACellOfOneAngstromIsNone) {
  EXPECT_FALSE(
      read("a.pdb", with(kPdb, "20.000   25.000   30.000", " 1.000    1.000    1.000")).box.periodic());
}

TEST(CoordinateFile, FurtherFramesAreNoted) {
  const Coordinates pdb = read("a.pdb", kPdb), gro = read("a.gro", kGro + kGro);
  EXPECT_EQ(gro.x, read("a.gro", kGro).x);
  EXPECT_THAT(pdb.note, testing::EndsWith("a.pdb: the first of its frames is taken"));
  EXPECT_THAT(gro.note, testing::EndsWith("a.gro: the first of its frames is taken"));
  EXPECT_EQ(read("a.pdb", kPdb.substr(0, kPdb.find("MODEL        2"))).note, "");
  // a box of each frame, and frames that END alone parts
  const std::string larger =
      "CRYST1   90.000   90.000   90.000  90.00  90.00  90.00 P 1           1\nMODEL        2";
  EXPECT_EQ(read("a.pdb", with(kPdb, "MODEL        2", larger)).box.edge, pdb.box.edge);
  EXPECT_EQ(read("a.pdb", with(kPdb, "ENDMDL", "END")).x, pdb.x);
  EXPECT_EQ(read("a.gro", kGro + "\n \n").note, "");
}

TEST(CoordinateFile, SaysWhatIsWrong) {
  const std::string six = "    6\n", box = "   1.82060   1.82060   1.82060";
  EXPECT_EQ(complaint("a.pdb", with(kPdb, "-2.500", "-2.5x0")),
            "a.pdb:4: expected a position, got \"-2.5x0\"");
  for (const auto& [old, changed, words] :
       {std::tuple("CA AGLY", "CA BGLY", "a.pdb:5: alternate location B"),
        {"90.00  90.00  90.00", "30.00  80.00 120.00", "a.pdb:2: its box: angles of 30, 80 and 120 degrees"}})
    EXPECT_THAT(complaint("a.pdb", with(kPdb, old, changed)), testing::HasSubstr(words));
  for (const auto& [old, changed, words] :
       {std::tuple(six, "    8\n", "a.gro:9: expected three positions"),
        {six, "  six\n", "a.gro:2: expected the number of atoms, got \"six\""},
        {box, "  1.8 1.8", "a.gro:9: expected the box, 3 or 9 numbers"},
        {"  1.9427 -0.8216 -0.0244", "", "a.gro:9: some atoms have velocities, others none"},
        {box, "2 2 2  0.1 0  0 0  0 0", "a.gro:9: its box: vectors not in reduced form"},
        {box, "2 -2 2", "a.gro:9: its box: edges of 2 x -2 x 2 nm"},
        {box, "2 2 nan", "a.gro:9: expected an edge of the box, got \"nan\""}})
    EXPECT_THAT(complaint("a.gro", with(kGro, old, changed)), testing::HasSubstr(words));
  EXPECT_EQ(complaint("a.pdb", "TITLE\n"), "a.pdb:2: there are no atoms in it");
  EXPECT_EQ(complaint("a.xyz", ""), "a.xyz: expected a file of coordinates, .pdb or .gro");
}

}  // namespace
}  // namespace taut::coordinate_file_tests
