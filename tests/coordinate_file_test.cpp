// Coordinates of PDB and GRO files, as other programs write them.

#include "files/coordinate_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "files/frame.hpp"
#include "files/pdb_file.hpp"
#include "md/errors.hpp"
#include "temporary_folder.hpp"

namespace taut {
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
  try {
    read_coordinates(folder.write(name, text));
  } catch (const InputError& e) {
    return std::string(e.what()).substr(folder.path().string().size() + 1);
  }
  return "no error";
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

TEST(CoordinateFile, ACellOfOneAngstromIsNone) {
  EXPECT_FALSE(
      read("a.pdb", with(kPdb, "20.000   25.000   30.000", " 1.000    1.000    1.000")).box.periodic());
}

TEST(CoordinateFile, SaysWhatIsWrong) {
  EXPECT_EQ(complaint("a.pdb", with(kPdb, "-2.500", "-2.5x0")),
            "a.pdb:4: expected a position, got \"-2.5x0\"");
  EXPECT_EQ(complaint("a.pdb", with(kPdb, "CA AGLY", "CA BGLY")),
            "a.pdb:5: alternate location B, expected one place for each atom");
  EXPECT_EQ(complaint("a.pdb", "TITLE\n"), "a.pdb:2: there are no atoms in it");
  EXPECT_EQ(complaint("a.gro", with(kGro, "    6\n", "    8\n")), "a.gro:9: expected three positions");
  EXPECT_EQ(complaint("a.gro", with(kGro, "    6\n", "    7\n")), "a.gro:9: expected three positions");
  EXPECT_EQ(complaint("a.gro", with(kGro, "    6\n", "  six\n")),
            "a.gro:2: expected the number of atoms, got \"six\"");
  EXPECT_EQ(complaint("a.gro", with(kGro, "   1.82060   1.82060   1.82060", "  1.8 1.8")),
            "a.gro:9: expected the box, 3 or 9 numbers");
  EXPECT_EQ(complaint("a.gro", with(kGro, "  1.9427 -0.8216 -0.0244", "")),
            "a.gro:9: some atoms have velocities, others none");
  EXPECT_EQ(complaint("a.xyz", ""), "a.xyz: expected a file of coordinates, .pdb or .gro");
}

}  // namespace
}  // namespace taut
