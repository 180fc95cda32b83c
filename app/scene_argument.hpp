#pragma once

#include <optional>
#include <string>
#include <vector>

#include "command_line.hpp"
#include "commands.hpp"
#include "systems/scene_file.hpp"

namespace taut {

// A scene's file or name, or a System and a State that OpenMM wrote.
struct NamedScene {
  std::string scene{};
  std::vector<std::string> openmm{};  // system.xml, state.xml

  void offer(const Subcommand& command);
  CommandLine line(const char* subcommand) const;  // as typed, so far
  // Throws InputError where both or neither were given.
  Scene read(const std::vector<std::string>& overrides, KeysRead* keys = nullptr) const;
};

// Which scene, and what is laid over its keys.
struct SceneArgument : NamedScene {
  std::optional<std::string> method;
  std::optional<long> steps;
  std::optional<std::string> precision;
  std::optional<double> dt_fs;
  std::vector<std::string> settings;

  void offer(const Subcommand& command);           // all, to what runs it or tells of it
  void offer_settings(const Subcommand& command);  // --dt-fs and --set, to studies
  std::vector<KeyFlag> flags() const;
  std::vector<std::string> overrides() const;  // of keys: flags and settings
  // `unless`: overrides that those said go before.
  Scene read(KeysRead* keys = nullptr, std::vector<std::string> unless = {}) const;
};

}  // namespace taut
