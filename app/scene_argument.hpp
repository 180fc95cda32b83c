#pragma once

#include <optional>
#include <string>
#include <vector>

#include "command_line.hpp"
#include "commands.hpp"
#include "simulation/open_run.hpp"
#include "systems/scene/scene_file.hpp"
#include "systems/scene/toml_reader.hpp"

namespace taut {

// The source of a scene: its file or name, or OpenMM's System and State.
struct NamedScene {
  std::string scene{};
  std::vector<std::string> openmm{};  // system.xml, state.xml

  void offer(const Subcommand& command);
  CommandLine line(const char* subcommand) const;  // the command line so far
  // Throws InputError if both sources or neither were given. `run` is told what it took of OpenMM's files.
  Scene read(const std::vector<std::string>& overrides, KeysRead* keys = nullptr,
             RunRequest* run = nullptr) const;
  bool as_run = false;  // as `taut run` reads OpenMM's files: with take_usual_settings()
};

// A scene and the overrides of its keys.
struct SceneArgument : NamedScene {
  std::optional<std::string> method;
  std::optional<long> steps;
  std::optional<std::string> precision;
  std::optional<double> dt_fs;
  std::vector<std::string> settings;

  void offer(const Subcommand& command);           // all options, for `run` and `info`
  void offer_settings(const Subcommand& command);  // --dt-fs and --set, for studies
  std::vector<KeyFlag> flags() const;
  std::vector<std::string> overrides() const;  // from flags and --set
  // `unless`: overrides that apply unless the user's replace them.
  Scene read(KeysRead* keys = nullptr, std::vector<std::string> unless = {}, RunRequest* run = nullptr) const;
};

}  // namespace taut
