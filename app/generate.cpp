#include <fmt/format.h>

#include <memory>

#include "base/nearest_name.hpp"
#include "commands.hpp"
#include "printing.hpp"

namespace taut {

void add_generate(Commands& commands) {
  auto what = std::make_shared<std::string>();
  const Subcommand command =
      commands.add("generate", "print completions for a shell, or the man page", [what, &commands] {
        expect_name("taut generate", *what, {"bash", "zsh", "man"});
        say_text(commands.generated(*what));
      });
  command.option("what", *what, "bash, zsh or man").required();
}

}  // namespace taut
