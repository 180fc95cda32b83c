#pragma once

#include <string>

namespace CLI {
class App;
}

namespace taut {

// What the parser knows of the command, for others: a page in roff, and what shells complete.
std::string man_page(const CLI::App& app);
std::string bash_completion(const CLI::App& app);
std::string zsh_completion(const CLI::App& app);

}  // namespace taut
