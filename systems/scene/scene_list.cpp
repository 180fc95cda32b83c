#include <fmt/format.h>

#include <algorithm>
#include <system_error>

#include "base/errors.hpp"
#include "base/nearest_name.hpp"
#include "files/resources.hpp"
#include "systems/scene/scene_file.hpp"
#include "systems/scene/toml_reader.hpp"

namespace fs = std::filesystem;

namespace taut {
namespace {

thread_local std::error_code ignored;

bool is_scene(const fs::path& file) {
  return file.extension() == ".toml" && file.stem().extension() != ".start";
}

}  // namespace

fs::path scenes_folder() {
  return resource_folder("scenes");
}

std::vector<SceneFolder> scene_folders() {
  return {{scenes_folder(), ""},
          {scenes_folder() / "worlds", "worlds of linkages"},
          {scenes_folder() / "hard", "hard ones, to try a method on"}};
}

std::vector<SceneSummary> list_scenes(const fs::path& folder) {
  std::vector<SceneSummary> scenes;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    if (!is_scene(entry.path())) continue;
    const toml::table table = parse_toml_file(entry.path());
    std::string hard_on;
    TomlTable(table, entry.path().string()).read("hard_on", hard_on);
    scenes.push_back({entry.path().stem().string(), hard_on});
  }
  std::ranges::sort(scenes, {}, &SceneSummary::name);
  return scenes;
}

fs::path find_scene(const std::string& name_or_path) {
  if (fs::is_regular_file(name_or_path, ignored)) return name_or_path;
  const bool there = fs::exists(name_or_path, ignored);
  std::vector<std::string> names;
  for (const auto& [folder, title] : scene_folders()) {
    fs::path named = folder / (name_or_path + ".toml");
    if (name_or_path.find('/') == std::string::npos && fs::is_regular_file(named, ignored)) return named;
    for (const auto& entry : fs::directory_iterator(folder, ignored))
      if (is_scene(entry.path())) names.push_back(entry.path().stem().string());
  }
  if (name_or_path == "-")
    throw InputError(
        "-: a scene is read from a file, not from standard input; save it to one, as scene.toml");
  if (fs::is_directory(name_or_path, ignored))
    throw InputError(name_or_path + ": a folder, not a scene's file");
  if (there) throw InputError(name_or_path + kPipe);
  std::ranges::sort(names);
  throw InputError(
      fmt::format("{}: no such file, and no scene of that name{}", name_or_path,
                  did_you_mean(fs::path(name_or_path).stem().string(), {names.begin(), names.end()})));
}

}  // namespace taut
