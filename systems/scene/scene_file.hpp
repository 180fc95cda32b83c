#pragma once

#include <toml++/toml.h>

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "systems/scene/keys.hpp"
#include "systems/scene/scene.hpp"

namespace taut {

// Reads a scene. `overrides` ("run.dt_fs=2", "build.molecules=1000", "method.name=rattle") replace the file's
// keys. Throws InputError, one line that names file, line and key, or the override. The sections are:
//
//   hard_on = "one sentence"      optional: what the scene is hard on
//   [build]       kind = "water", and the keys of that kind (builders.hpp)
//   [atom.NAME], [molecule.NAME], [[place]]      molecules of the user (build_molecules.cpp)
//   [forcefield]  the pair forces, for kinds that have them
//   [run]         the keys of RunSettings
//   [method]      name = "newton", and the keys of that method's Options
//
// All sections of the file and the overrides are merged first and then read once, so that each may complete the other.
//
// If an override changes method.name, the file's other keys of [method] are ignored, because they were chosen
// for another method: the new method has its defaults and the overrides. If an override changes build.start,
// the file's run.velocities, run.minimise and run.soft_start are ignored in the same way.
//
// A key without effect is refused, e.g. friction_per_ps without Langevin's thermostat. A key of the file that an
// override leaves without effect is set aside.
//
struct SceneReading {
  std::vector<std::filesystem::path> files{};  // replacements for the files that the scene names
  KeysRead* keys = nullptr;                    // receives every key that is read, with its value and source
};
Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides = {},
                 const SceneReading& how = {});

// The same for a file that is parsed already.
Scene read_scene(toml::table&& table, const std::filesystem::path& file,
                 const std::vector<std::string>& overrides = {}, const SceneReading& how = {});

// Applies overrides of [run] and [method] to a scene from another source, by the same rules. Velocities are
// drawn according to run.velocities.
void apply_overrides(Scene& scene, const std::vector<std::string>& overrides, KeysRead* keys = nullptr);

// Returns the method that overrides of [method] make of the default one. Throws LocatedError for a name or options that
// no scene would take.
MethodOptions method_of(const std::vector<std::string>& overrides);
// The same of a method in one word, as commands and studies take it: "rattle:sweeps=4". Errors begin with the word.
MethodOptions method_in_word(const std::string& word);

// Returns every key of every kind and method with its description, by reading scenes without keys. A key that
// several kinds or methods describe alike is listed once.
std::vector<Key> every_key();
// The sections of keys; "start" has those of the file that build.start names.
inline constexpr std::array<std::string_view, 14> kSections = {
    "",     "atom.NAME", "molecule.NAME", "molecule.NAME.tables", "place", "pair",   "wall",
    "bias", "motion",    "build",         "forcefield",           "run",   "method", "start"};

struct SceneSummary {
  std::string name, hard_on;
};

// Returns the folder of the scenes that come with taut. Throws OutsideError if it is missing.
std::filesystem::path scenes_folder();

// Returns the folders of scenes with their titles: general ones, linkages, and those that are hard on
// methods.
struct SceneFolder {
  std::filesystem::path path;
  const char* title;
};
std::vector<SceneFolder> scene_folders();

// Returns every scene of a folder, sorted by name.
std::vector<SceneSummary> list_scenes(const std::filesystem::path& folder = scenes_folder());

// What is said of an input that is no file, but can be read.
inline constexpr const char* kPipe =
    ": a pipe or a device, which can be read once only; a run reads its input again: save it to a file";

// Returns the file of a scene, given by its path or as "water" for one of scene_folders(). Throws InputError
// with the nearest name.
std::filesystem::path find_scene(const std::string& name_or_path);

}  // namespace taut
