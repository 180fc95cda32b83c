// What trajectory files hold, and how they come back after a stop at any instant. What other programs read
// in them is tested by read_trajectory.py.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "base/errors.hpp"
#include "base/random.hpp"
#include "error_message.hpp"
#include "file_text.hpp"
#include "files/dcd_file.hpp"
#include "files/h5md_file.hpp"
#include "files/hdf5_driver.hpp"
#include "files/pdb_file.hpp"
#include "temporary_folder.hpp"

namespace taut::trajectory_tests {
namespace {

using ::testing::HasSubstr;

std::string read_all(const JournaledFile& file) {
  std::string text(file.size(), '?');
  file.read(0, text.data(), text.size());
  return text;
}

// Random writes, cuts and stops, beside a string that does the same.
TEST(JournaledFile, IsAPlainFileThatForgetsWhatWasNotCommitted) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "file";
  Random random(7);
  std::string now, committed;
  auto file = std::make_unique<JournaledFile>(path, DiskFile::kNew);
  const auto below = [&](std::size_t n) {
    return static_cast<std::size_t>(random.uniform() * static_cast<double>(n));
  };
  for (int n = 0; n < 600; ++n) {
    const double die = random.uniform();
    if (die < 0.8) {
      const std::string bytes(1 + below(6000), static_cast<char>('a' + n % 26));
      const std::size_t at = below(now.size() + 1);
      now.resize(std::max(now.size(), at + bytes.size()));
      now.replace(at, bytes.size(), bytes);
      file->write(at, bytes);
    } else if (die < 0.9) {
      now.resize(now.size() - below(now.size() / 4 + 1));
      file->commit(now.size());
      committed = now;
    } else {
      file.reset();
      file = std::make_unique<JournaledFile>(path, DiskFile::kThere);
      ASSERT_EQ(contents(path).substr(0, committed.size()), committed);
      file->commit(committed.size());
      now = committed;
    }
    ASSERT_EQ(read_all(*file), now) << n;
  }
}

TEST(JournaledFile, CarriesOutTheJournalItFinds) {
  const TemporaryFolder folder;
  const fs::path path = folder.write("file", "0123456789");
  const std::uint64_t change[] = {3, 4};
  folder.write("file.journal", std::string(reinterpret_cast<const char*>(change), sizeof change) + "DEFG");
  {
    const JournaledFile read(path, DiskFile::kRead);
    EXPECT_EQ(read_all(read), "012DEFG789");
  }
  EXPECT_EQ(contents(path), "0123456789");
  EXPECT_TRUE(fs::exists(folder.path() / "file.journal"));
  const JournaledFile file(path, DiskFile::kThere);
  EXPECT_EQ(contents(path), "012DEFG789");
  EXPECT_FALSE(fs::exists(folder.path() / "file.journal"));
}

TEST(Hdf5Medium, LeavesAFileAloneThatHdf5DoesNotWriteThroughIt) {
  const TemporaryFolder folder;
  const fs::path path = folder.write("file", "of somebody else");
  Hdf5Medium medium{JournaledFile(path, DiskFile::kThere), 0, {}};
  EXPECT_THROW(medium.commit(), OutsideError);
  EXPECT_EQ(contents(path), "of somebody else");
}

// Two waters and an atom, in motion.
struct Sample {
  System sys = make_system(Eigen::VectorXd{{15.999, 1.008, 1.008, 15.999, 1.008, 1.008, 39.95}},
                           {{0, 1, 0.1}, {0, 2, 0.1}, {3, 4, 0.1}, {3, 5, 0.1}});
  Names names = guessed_names({sys.mass.begin(), sys.mass.end()}, {0, 0, 0, 1, 1, 1, 2});
  State state{Vectors::Random(3, 7), Vectors::Random(3, 7), Vectors::Random(3, 7), 0, Box{Vec3(2, 3, 4)}};
  Eigen::VectorXd tension = Eigen::VectorXd::Random(4);
  TrajectorySetup setup{sys, names, 0.002, 10, 0, true};

  Frame at(long frame) {
    state.t = 0.02 * static_cast<double>(frame);
    state.x.setConstant(static_cast<double>(frame));
    return {10 * frame, state, tension};
  }
};

template <class File>
class Trajectories : public testing::Test {};
using Kinds = testing::Types<DcdFile, H5mdFile>;
TYPED_TEST_SUITE(Trajectories, Kinds);

// Written in one go, and with frames lost and written again.
TYPED_TEST(Trajectories, GoOnFromAMark) {
  const TemporaryFolder folder;
  Sample sample;
  std::uint64_t mark = 0, end = 0;
  {
    TypeParam whole(folder.path() / "whole", sample.setup, 0);
    for (long n = 0; n < 60; ++n) whole.add(sample.at(n));
    end = whole.mark();
  }
  {
    TypeParam first(folder.path() / "parts", sample.setup, 0);
    for (long n = 0; n < 50; ++n) {
      if (n == 20) mark = first.mark();
      first.add(sample.at(n < 20 ? n : -n));
    }
  }
  ASSERT_GT(mark, 0u);
  {
    TypeParam second(folder.path() / "parts", sample.setup, mark);
    for (long n = 20; n < 60; ++n) second.add(sample.at(n));
    EXPECT_EQ(second.mark(), end);
  }
  if (std::is_same_v<TypeParam, DcdFile>) {
    EXPECT_EQ(contents(folder.path() / "parts"), contents(folder.path() / "whole"));
  }
}

TYPED_TEST(Trajectories, RefuseToGoOnFromSomethingElse) {
  const TemporaryFolder folder;
  Sample sample;
  std::uint64_t mark = 0;
  {
    TypeParam file(folder.path() / "file", sample.setup, 0);
    file.add(sample.at(0));
    mark = file.mark();
  }
  EXPECT_THROW(TypeParam(folder.path() / "file", sample.setup, 1000 * mark), OutsideError);
  EXPECT_THROW(TypeParam(folder.path() / "none", sample.setup, mark), OutsideError);
  EXPECT_THROW(TypeParam(folder.write("words", std::string(100000, 'x')), sample.setup, mark + 1),
               OutsideError);
  const System other = make_system(Eigen::VectorXd::Ones(3), {});
  EXPECT_THROW(TypeParam(folder.path() / "file", {other, sample.names, 0.002, 10, 0}, mark), OutsideError);
}

TYPED_TEST(Trajectories, SayThatTheDiskIsFull) {
  Sample sample;
  EXPECT_EQ(error_message<OutsideError>([&] {
              TypeParam file("/dev/full", sample.setup, 0);
              for (long n = 0; n < 100; ++n) file.add(sample.at(n));
              file.mark();
            }),
            "/dev/full: cannot write: No space left on device");
}

TEST(H5mdFile, IsOnDiskOnceItIsMarked) {
  const TemporaryFolder folder;
  Sample sample;
  H5mdFile file(folder.path() / "t.h5md", sample.setup, 0);
  for (long n = 0; n < 3; ++n) file.add(sample.at(n));
  file.mark();
  const H5Handle read{H5Fopen((folder.path() / "t.h5md").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose};
  const H5Maker in(read);
  for (const char* group : {"position", "velocity", "force", "box/edges"})
    EXPECT_EQ(in.frames(in.open(std::string("/particles/all/") + group + "/value")), 3u) << group;
  EXPECT_EQ(in.frames(in.open("/observables/tension/value")), 3u);
}

// A program that uses HDF5 itself may have errors told to it.
TEST(H5mdFile, SaysWhatHdf5SaysToItsCallerAlone) {
  const TemporaryFolder folder;
  Sample sample;
  int told = 0;
  const H5E_auto2_t tell = [](hid_t, void* count) -> herr_t {
    ++*static_cast<int*>(count);
    return 0;
  };
  H5E_auto2_t before = nullptr, after = nullptr;
  void *to_before = nullptr, *to_after = nullptr;
  H5Eget_auto2(H5E_DEFAULT, &before, &to_before);
  H5Eset_auto2(H5E_DEFAULT, tell, &told);
  try {
    H5mdFile(folder.write("words", std::string(10000, 'x')), sample.setup, 1);
    ADD_FAILURE();
  } catch (const OutsideError& e) {
    EXPECT_THAT(e.what(), testing::MatchesRegex(".*/words: HDF5: unable to .*open file: .*signature.*"));
  }
  EXPECT_EQ(H5mdFile::frames(folder.path() / "words", sample.setup), 0u);
  EXPECT_EQ(told, 0);
  H5Eget_auto2(H5E_DEFAULT, &after, &to_after);
  EXPECT_EQ(after, tell);
  EXPECT_EQ(to_after, &told);
  H5Eset_auto2(H5E_DEFAULT, before, to_before);
}

TEST(DcdFile, CountsItsFramesInItsHeader) {
  const TemporaryFolder folder;
  Sample sample;
  DcdFile file(folder.path() / "t.dcd", sample.setup, 0);
  for (long n = 0; n < 3; ++n) file.add(sample.at(n));
  const std::string bytes = contents(folder.path() / "t.dcd");
  std::int32_t control[20];
  std::memcpy(control, bytes.data() + 8, sizeof control);
  float step;
  std::memcpy(&step, &control[9], sizeof step);
  EXPECT_EQ(control[0], 3);
  EXPECT_EQ(control[2], 10);
  EXPECT_EQ(control[3], 30);
  EXPECT_NEAR(step * 0.0488882129, 0.002, 1e-9);
  EXPECT_EQ(control[10], 1);
  EXPECT_EQ(bytes.size(), 196u + 3 * (56 + 3 * (8 + 28)));
}

// Another program's steps between frames, or length of a step, are not divided by.
TEST(DcdFile, RefusesToGoOnFromAHeaderWithoutSteps) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "t.dcd";
  Sample sample;
  std::uint64_t mark = 0;
  {
    DcdFile file(path, sample.setup, 0);
    file.add(sample.at(0));
    mark = file.mark();
  }
  const std::string whole = contents(path);
  const auto refusal = [&](std::size_t number) {  // of the header's, each of 4 bytes
    std::ofstream(path, std::ios::binary) << std::string(whole).replace(8 + 4 * number, 4, 4, '\0');
    return error_message<OutsideError>([&] { DcdFile(path, sample.setup, mark).add(sample.at(1)); });
  };
  EXPECT_THAT(refusal(2), testing::HasSubstr("t.dcd: cannot go on: its header has 0 steps of 0.04"));
  EXPECT_THAT(refusal(9), testing::HasSubstr("t.dcd: cannot go on: its header has 10 steps of 0 AKMA units"));
}

// CHARMM's cell is A, γ, B, β, α, C; then all x, all y, all z, in Å.
// A file that goes beyond the 2147483647 steps that its header can count, from its start, from a frame on, or
// after it was opened again: readers find each frame's time, first / every + frame times every · step.
TEST(DcdFile, TellsTheTimeBeyondTheStepsItCanCount) {
  const long most = 2147483647;
  for (const long before : {0L, most - 25, 5 * most})
    for (const long every : {10L, 3 * most}) {
      const TemporaryFolder folder;
      const fs::path path = folder.path() / "t.dcd";
      Sample sample;
      sample.setup.every = every;
      const long first = before / every * every;
      sample.setup.t0 = static_cast<double>(first) * sample.setup.h;
      std::uint64_t mark = 0;
      for (int frame = 0; frame < 6; ++frame) {
        DcdFile file(path, sample.setup, mark);
        file.add(sample.at(0));
        mark = file.mark();
        std::array<std::int32_t, 20> control;
        std::memcpy(control.data(), contents(path).data() + 8, sizeof control);
        float step = 0;
        std::memcpy(&step, &control[9], sizeof step);
        EXPECT_EQ(control[0], frame + 1);
        EXPECT_GE(control[1], 0);
        EXPECT_GT(control[2], 0);
        EXPECT_EQ(control[3], control[0] * static_cast<long>(control[2]));
        const double interval = static_cast<double>(step) * kAkma * control[2];
        const double time = (frame + static_cast<double>(control[1]) / control[2]) * interval;
        const double expected = static_cast<double>(first + frame * every) * sample.setup.h;
        EXPECT_NEAR(interval / (static_cast<double>(every) * sample.setup.h), 1, 1e-6);
        EXPECT_NEAR(time, expected, 1e-6 * expected)
            << "frame " << frame << " from step " << first << " by " << every;
        sample.setup.t0 =
            expected;  // of a run that goes on: its next frame's, which the header does not take
      }
    }
}

TEST(DcdFile, HasTheCellAndEachAxisInTurn) {
  const TemporaryFolder folder;
  Sample sample;
  sample.setup.t0 = 0.5;
  DcdFile file(folder.path() / "t.dcd", sample.setup, 0);
  const Vectors x = sample.state.x;
  file.add({250, sample.state, sample.tension});
  const std::string bytes = contents(folder.path() / "t.dcd");
  std::int32_t first_step;
  std::memcpy(&first_step, bytes.data() + 12, 4);
  EXPECT_EQ(first_step, 250);
  double cell[6];
  std::memcpy(cell, bytes.data() + 196 + 4, sizeof cell);
  EXPECT_THAT(cell, testing::ElementsAre(20, 90, 30, 90, 90, 40));
  for (int axis = 0; axis < 3; ++axis) {
    float row[7];
    std::memcpy(row, bytes.data() + 196 + 56 + axis * (8 + 28) + 4, sizeof row);
    for (int a = 0; a < 7; ++a) EXPECT_FLOAT_EQ(row[a], static_cast<float>(10 * x(axis, a)));
  }
}

TEST(PdbFile, HasEveryThingInItsColumns) {
  const TemporaryFolder folder;
  Sample sample;
  sample.state.x.col(0) << 0.1234, -0.5, 12345.678;
  write_pdb(folder.path() / "s.pdb", sample.setup, sample.state);
  const std::string text = contents(folder.path() / "s.pdb");
  EXPECT_THAT(text, HasSubstr("CRYST1   20.000   30.000   40.000  90.00  90.00  90.00 P 1           1\n"));
  EXPECT_THAT(text,
              HasSubstr("HETATM    1  O   HOH     1       1.234  -5.000123456.8  1.00  0.00           O\n"));
  EXPECT_THAT(text, HasSubstr("HETATM    5  H1  HOH     2    "));
  EXPECT_THAT(text, HasSubstr("HETATM    7 Ar1  MOL     3    "));
  EXPECT_THAT(text, HasSubstr("CONECT    4    6\n"));
  sample.names.kinds[static_cast<std::size_t>(sample.names.kind[0])] = {
      .atom = "B", .residue = "MOL", .element = ""};
  write_pdb(folder.path() / "s.pdb", sample.setup, sample.state);
  EXPECT_THAT(contents(folder.path() / "s.pdb"),
              HasSubstr("HETATM    1  B   MOL     1       1.234  -5.000123456.8  1.00  0.00           X\n"));
  sample.setup.further_bonds = {{0, 6}};
  write_pdb(folder.path() / "s.pdb", sample.setup, sample.state);
  EXPECT_THAT(contents(folder.path() / "s.pdb"), HasSubstr("CONECT    1    7\nEND"));
}

}  // namespace
}  // namespace taut::trajectory_tests
