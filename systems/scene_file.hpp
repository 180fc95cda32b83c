#pragma once

#include <toml++/toml.h>

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "systems/keys.hpp"
#include "systems/scene.hpp"

namespace taut {

// Reads a scene, `overrides` ("run.dt_fs=2", "build.molecules=1000", "method.name=rattle") laid over the
// file's keys. Throws InputError with one line naming file, line and key, or the override.
//
//   hard_on = "one sentence"      if you like
//   [build]       kind = "water", and the keys of that kind (builders.hpp)
//   [atom.NAME], [molecule.NAME], [[place]]      molecules of one's own (build_molecules.cpp)
//   [forcefield]  the pair forces, for the kinds that have them
//   [run]         the keys of RunSettings
//   [method]      name = "newton", and the keys of that method's Options; what is not said is its default
//
// An override that changes method.name sets the file's other keys of [method] aside: they were chosen for
// another method. Only what the overrides say of the new one counts, on top of its defaults. One that
// names the file's own method changes nothing. So does one of build.start with the file's run.velocities.
//
// A key that nothing reads, as the others are, is refused: friction_per_ps without Langevin's thermostat.
//
struct SceneReading {
  std::vector<std::filesystem::path> files{};  // where those that it names are read from, if not from there
  KeysRead* keys = nullptr;  // takes every key that was read, with its value and who said it
};
Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides = {},
                 const SceneReading& how = {});

// The same of a file parsed already.
Scene read_scene(toml::table&& table, const std::filesystem::path& file,
                 const std::vector<std::string>& overrides = {}, const SceneReading& how = {});

// The [run] and [method] sections alone, from overrides over what the scene has, by the same rules: for
// systems that come from elsewhere. Velocities are drawn as run.velocities says.
void apply_overrides(Scene& scene, const std::vector<std::string>& overrides, KeysRead* keys = nullptr);

// Every key there is, of every kind and method, with what there is to know of it: what a scene without keys
// is asked for. A key that kinds or methods describe alike is there once.
std::vector<Key> every_key();
// "start": those of the file that build.start names.
inline constexpr std::array<std::string_view, 9> kSections = {
    "", "atom.NAME", "molecule.NAME", "place", "build", "forcefield", "run", "method", "start"};

struct SceneSummary {
  std::string name, hard_on;
};

// The scenes that come with taut. Throws OutsideError where they did not.
std::filesystem::path scenes_folder();

// Where they lie, and what they are: the first for everybody, worlds of linkages, what is hard on methods.
struct SceneFolder {
  std::filesystem::path path;
  const char* title;
};
std::vector<SceneFolder> scene_folders();

// Every scene of a folder, by name.
std::vector<SceneSummary> list_scenes(const std::filesystem::path& folder = scenes_folder());

// The file of a scene named by its path, or as "water" for one of scene_folders().
// Throws InputError, with the nearest name.
std::filesystem::path find_scene(const std::string& name_or_path);

}  // namespace taut
