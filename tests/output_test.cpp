// Files that grow, are cut back, and are refused.

#include "files/output.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "base/errors.hpp"
#include "error_message.hpp"
#include "file_text.hpp"
#include "files/atomic_file.hpp"
#include "files/folder.hpp"
#include "temporary_folder.hpp"

namespace taut::output_tests {
namespace {

TEST(GrowingFile, GoesOnFromItsMark) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "log";
  std::uint64_t mark = 0;
  {
    GrowingFile file(path, 0);
    file.write("one\n");
    mark = file.mark();
    file.write("lost\n");
    EXPECT_EQ(contents(path), "one\nlost\n");  // without a flush
  }
  EXPECT_EQ(mark, 4u);
  GrowingFile again(path, mark);
  EXPECT_EQ(contents(path), "one\n");
  again.write("two\n");
  again.rewrite(0, "ONE");
  EXPECT_EQ(contents(path), "ONE\ntwo\n");
  EXPECT_EQ(again.mark(), 8u);
  EXPECT_EQ(GrowingFile(path, 0).mark(), 0u);
  EXPECT_EQ(contents(path), "");
}

TEST(GrowingFile, RefusesToGoOnFromWhatIsNotThere) {
  const TemporaryFolder folder;
  EXPECT_THROW(GrowingFile(folder.path() / "none", 3), OutsideError);
  EXPECT_THROW(GrowingFile(folder.write("short", "ab"), 3), OutsideError);
}

TEST(GrowingFile, ThatWasRemovedIsNotTakenForWritten) {
  const TemporaryFolder folder;
  GrowingFile file(folder.path() / "log", 0);
  file.write("one\n");
  fs::remove(folder.path() / "log");
  EXPECT_THROW(file.mark(), OutsideError);
}

TEST(GrowingFile, SaysThatTheDiskIsFull) {
  GrowingFile full("/dev/full", 0);
  EXPECT_EQ(error_message<OutsideError>([&] { full.write("one\n"); }),
            "/dev/full: cannot write: No space left on device");
}

TEST(FolderLock, IsHeldByOneAtATime) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "a" / "b";
  {
    const FolderLock lock(path);
    EXPECT_THROW(FolderLock{path}, InputError);
    const FolderLock other(folder.path() / "a");
  }
  FolderLock again(path);
  const FolderLock moved(std::move(again));
  EXPECT_EQ(moved.path(), path);
  EXPECT_THROW(FolderLock{path}, InputError);
}

TEST(AtomicFile, IsSeenWholeOrNotAtAll) {
  const TemporaryFolder folder;
  const fs::path path = folder.write("state", "old");
  {
    AtomicFile dropped(path);
    dropped.write("ne");
    EXPECT_EQ(contents(path), "old");
  }
  EXPECT_FALSE(fs::exists(path.string() + ".part"));
  AtomicFile file(path);
  file.write("ne");
  file.write("w");
  file.commit();
  EXPECT_EQ(contents(path), "new");
  EXPECT_FALSE(fs::exists(path.string() + ".part"));
}

}  // namespace
}  // namespace taut::output_tests
