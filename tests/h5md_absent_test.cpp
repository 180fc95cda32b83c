// A build without HDF5 says so.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "error_message.hpp"
#include "files/h5md_file.hpp"
#include "systems/scene/scene_file.hpp"

namespace taut::h5md_absent_tests {
namespace {

TEST(H5mdAbsent, NamesTheKeyAndThePackage) {
  EXPECT_FALSE(built_with_hdf5());
  for (const std::string format : {"h5md", "both"})
    EXPECT_THAT(error_message([&] {
                  read_scene(find_scene("pair"), {"run.trajectory_every=1", "run.trajectory=" + format});
                }),
                testing::AllOf(testing::HasSubstr("trajectory"), testing::HasSubstr("libhdf5-dev")));
  EXPECT_EQ(read_scene(find_scene("pair"), {"run.trajectory_every=1"}).run.trajectory, "dcd");
}

}  // namespace
}  // namespace taut::h5md_absent_tests
