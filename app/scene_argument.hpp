#pragma once

#include <optional>
#include <string>
#include <vector>

#include "command_line.hpp"
#include "commands.hpp"
#include "systems/scene_file.hpp"

namespace taut {

// Which scene, and what is laid over its keys: what `run` and `info` are both asked.
struct SceneArgument {
  std::string scene;
  std::vector<std::string> openmm;  // system.xml, state.xml
  std::optional<std::string> method;
  std::optional<long> steps;
  std::optional<double> dt_fs;
  std::vector<std::string> settings;

  void offer(const Subcommand& command);
  std::vector<KeyFlag> flags() const;
  std::vector<std::string> overrides() const;  // of keys: flags and settings
  Scene read(KeysRead* keys = nullptr) const;
};

}  // namespace taut
