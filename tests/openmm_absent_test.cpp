// A build without OpenMM says what is missing.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/errors.hpp"
#include "error_message.hpp"
#include "studies/crosscheck.hpp"
#include "studies/openmm_twin.hpp"
#include "systems/scene/scene_file.hpp"

namespace taut::openmm_absent_tests {
namespace {

TEST(OpenMMAbsent, NamesThePackage) {
  EXPECT_FALSE(built_with_openmm());
  EXPECT_THROW(OpenMMTwin("a.xml", "b.xml", {0.001}), InputError);
  EXPECT_THROW(crosscheck(read_scene(find_scene("pair")), {}), InputError);
  EXPECT_THAT(error_message([&] { openmm_version(); }),
              testing::AllOf(::testing::HasSubstr("without OpenMM"), ::testing::HasSubstr("lib")));
}

}  // namespace
}  // namespace taut::openmm_absent_tests
