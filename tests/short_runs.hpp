#pragma once

#include <gtest/gtest.h>

#include <optional>

#include "taut_command.hpp"
#include "temporary_folder.hpp"

namespace taut::tests {

constexpr const char* kShortRun = "run freely_jointed --steps 200 --set build.chains=10 run.log_every=2 ";

// Runs in a folder, which are looked at.
struct ShortRuns : ::testing::Test {
  const TemporaryFolder folder;
  std::optional<Undrawn> undrawn{std::in_place};  // unless a test looks at a picture
  const std::string at = folder.path().string() + "/";
};

}  // namespace taut::tests
