#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace taut {

// A file a subcommand: each adds itself to the command line, and returns what to do when it was chosen.
using Action = std::function<void()>;
void add_run(CLI::App& app, std::vector<std::pair<CLI::App*, Action>>& actions);
void add_resume(CLI::App& app, std::vector<std::pair<CLI::App*, Action>>& actions);
void add_calibrate(CLI::App& app, std::vector<std::pair<CLI::App*, Action>>& actions);
void add_crosscheck(CLI::App& app, std::vector<std::pair<CLI::App*, Action>>& actions);
void add_chart(CLI::App& app, std::vector<std::pair<CLI::App*, Action>>& actions);
void add_stability(CLI::App& app, std::vector<std::pair<CLI::App*, Action>>& actions);
void add_lists(CLI::App& app, std::vector<std::pair<CLI::App*, Action>>& actions);

}  // namespace taut
