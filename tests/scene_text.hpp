#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "error_message.hpp"
#include "systems/scene/scene_file.hpp"
#include "temporary_folder.hpp"

namespace taut {

// A scene in a file, changed by replacing one text with another.
struct SceneText {
  std::string text = R"(hard_on = "a test"
[build]
kind = "atoms"
atoms = [
  [0, 0, 0, 0],
  [1, 0, 0, 1],
  [2, 0, 0, 1.5],
]
bonds = [
  [0, 1, 1],
  [1, 2, 1],
]
gravity_nm_ps2 = [0, -9.81, 0]
pulls = [[2, 1, 2, 3]]
[run]
dt_fs = 0.5
steps = 20
[method]
name = "baumgarte"
alpha_per_ps = 3.0
max_solves = 2
)";

  inline SceneText with(const std::string& old, const std::string& changed) const {
    const auto at = text.find(old);
    EXPECT_NE(at, std::string::npos) << old;
    return {std::string(text).replace(at, old.size(), changed)};
  }
};

// Two bars between an anchor and one that moves off, beyond their reach after 0.4 ps.
inline const SceneText kApart{R"(motion = [{atoms = [2], velocity_nm_ps = [1, 0, 0]}]
run = {dt_fs = 1, steps = 390}
[build]
kind = "atoms"
atoms = [[0, 0, 0, 0], [0.8, 0.6, 0, 1], [1.6, 0, 0, 0]]
bonds = [[0, 1, 1], [1, 2, 1]]
)"};

inline const std::string kMelt = R"(hard_on = "a test"
[build]
kind = "melt"
chains = 10
beads = 20
bond_nm = 0.97
mass_u = 1.0
density_per_nm3 = 0.85
bonds = "rigid"
[forcefield]
pair = "lennard-jones"
sigma_nm = 1.0
epsilon_kj_mol = 1.0
cutoff_nm = 2.5
)";

// What reading says, with the file's folder taken out; the folder is left as it was.
inline std::string complaint(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const TemporaryFolder folder;
  const auto file = folder.write("scene.toml", text);
  const std::string message = folder.without_path(error_message([&] { read_scene(file, overrides); }));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
  EXPECT_THAT(message, testing::Not(testing::HasSubstr("\n")));
  return message;
}

inline Scene read(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const TemporaryFolder folder;
  return read_scene(folder.write("scene.toml", text), overrides);
}

// Changes of a scene's text, or settings laid over it, each with words of what reading then says.
struct Change {
  std::string old, changed, words;
};

inline void expect_said(const SceneText& scene, const std::vector<Change>& changes) {
  for (const auto& [old, changed, words] : changes)
    EXPECT_THAT(complaint(scene.with(old, changed).text), testing::HasSubstr(words)) << changed;
}

struct Overriding {
  std::vector<std::string> overrides;
  std::string words;
};

inline void expect_said_of(const std::string& text, const std::vector<Overriding>& all) {
  for (const auto& [overrides, words] : all)
    EXPECT_THAT(complaint(text, overrides), testing::HasSubstr(words)) << testing::PrintToString(overrides);
}

}  // namespace taut
