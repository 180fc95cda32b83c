#pragma once

#include <string>

namespace CLI {
class App;
}

namespace taut {

// The man page in roff, and completions for shells, from the description of the command line.
std::string man_page(const CLI::App& app);
std::string bash_completion(const CLI::App& app);
std::string zsh_completion(const CLI::App& app);

}  // namespace taut
