#include "generated.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <string_view>
#include <vector>

#include "base/nearest_name.hpp"
#include "commands.hpp"
#include "printing.hpp"

namespace taut {
namespace {

std::vector<const CLI::App*> subcommands(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* sub) { return !sub->get_name().empty(); });
}

std::string long_name(const CLI::Option& option) {
  return option.get_lnames().empty() ? "" : "--" + option.get_lnames()[0];
}

bool takes_value(const CLI::Option& option) {
  return option.get_items_expected_max() > 0;
}

// Escapes special characters with a backslash.
std::string escaped(std::string_view text, std::string_view special) {
  std::string out;
  for (const char c : text) {
    if (special.find(c) != special.npos) out += '\\';
    out += c;
  }
  return out;
}

// Escapes text for roff, where a line must not begin with a dot or a quote, and "-" is a hyphen.
std::string roff(std::string_view text) {
  const std::string line = escaped(text, "-\\");
  return !line.empty() && (line[0] == '.' || line[0] == '\'') ? "\\&" + line : line;
}

std::string option_entry(const CLI::Option& option) {
  const std::string name = long_name(option), value = takes_value(option) ? option.get_type_name() : "";
  const std::string head = name.empty() ? roff(option.get_name(true)) : roff(name);
  const std::string with = value.empty() || name.empty() ? "" : fmt::format(" \\fI{}\\fR", roff(value));
  const std::string unless = option.get_default_str();
  return fmt::format(".TP\n\\fB{}\\fR{}\n{}{}\n", head, with, roff(option.get_description()),
                     unless.empty() ? "" : fmt::format(" (if not said: {})", roff(unless)));
}

// Returns the command that lists the values of a type of word, or nothing for a file.
std::string lister(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  if (type == "SCENE") return "taut scenes --names";
  if (type == "METHOD") return "taut methods --names";
  if (type == "KEY" || type == "KEY=VALUE") return "taut help --names";
  return "";
}

std::vector<const CLI::Option*> positionals(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) { return option->get_positional(); });
}

std::vector<std::string> flags_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    if (const std::string name = long_name(*option); !name.empty()) names.push_back(name);
  return names;
}

}  // namespace

std::string man_page(const CLI::App& app) {
  std::string page = fmt::format(
      ".TH TAUT 1 \"\" \"taut {}\" \"User commands\"\n.SH NAME\ntaut \\- {}\n"
      ".SH SYNOPSIS\n.B taut\n\\fICOMMAND\\fR [\\fIOPTION\\fR...]\n.SH COMMANDS\n",
      TAUT_VERSION, roff(app.get_description().substr(6)));
  for (const CLI::App* sub : subcommands(app)) {
    page += fmt::format(".SS taut {}", roff(sub->get_name()));
    for (const CLI::Option* option : positionals(*sub))
      page += option->get_required() ? " " + roff(option->get_type_name())
                                     : fmt::format(" [{}]", roff(option->get_type_name()));
    page += fmt::format("\n{}\n", roff(sub->get_description()));
    for (const CLI::Option* option : sub->get_options())
      if (long_name(*option) != "--help") page += option_entry(*option);
  }
  page += ".SH OPTIONS\nFor every command:\n";
  for (const CLI::Option* option : app.get_options()) page += option_entry(*option);
  page +=
      ".SH EXIT STATUS\n0 done; 1 the simulation failed; 2 the input is wrong; 3 something outside (disk, "
      "memory, an "
      "output that is not taken); 128 + the signal where one asked it to stop.\n"
      ".SH ENVIRONMENT\n.TP\n.B OMP_NUM_THREADS\nhow many threads compute, unless \\-\\-threads says so\n"
      ".SH SEE ALSO\n\\fBtaut help\\fR \\fIKEY\\fR explains each key of a scene.\n";
  return page;
}

namespace {

// One function of bash, in which the previous word determines the completions.
std::string completion_function(const CLI::App& app) {
  std::string cases;
  std::vector<std::string> names;
  for (const CLI::App* sub : subcommands(app)) {
    names.push_back(sub->get_name());
    std::string values;
    for (const CLI::Option* option : sub->get_options()) {
      if (long_name(*option).empty()) continue;
      if (const std::string list = lister(*option); !list.empty())
        values += fmt::format("        {}) words=$({} 2>/dev/null) ;;\n", long_name(*option), list);
      else if (takes_value(*option))
        values += fmt::format("        {}) ;;\n", long_name(*option));
    }
    std::string plain;
    for (const CLI::Option* option : positionals(*sub))
      if (const std::string list = lister(*option); !list.empty())
        plain = fmt::format(" $({} 2>/dev/null)", list);
    cases += fmt::format("    {}) case $last in\n{}        *) words=\"{}{}\" ;;\n      esac ;;\n",
                         sub->get_name(), values, fmt::join(flags_of(*sub), " "), plain);
  }
  return fmt::format(
      R"(_taut_words() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} command= last= words= k
  for ((k = 1; k < COMP_CWORD; ++k)); do
    case ${{COMP_WORDS[k]}} in
      -*) last=${{COMP_WORDS[k]}} ;;
      *) [[ -z $command ]] && command=${{COMP_WORDS[k]}}
         [[ $last != --set && $last != --methods || ${{COMP_WORDS[k]}} == "$word" ]] && last= ;;
    esac
  done
  [[ $word == -* ]] && last=
  case $command in
{}    *) words="{} {}" ;;
  esac
  COMPREPLY=($(compgen -W "$words" -- "$word"))
  if [[ $last == --set ]]; then
    COMPREPLY=("${{COMPREPLY[@]/%/=}}")
    compopt -o nospace
  fi
  [[ ${{#COMPREPLY[@]}} -eq 0 ]] && compopt -o default
  return 0
}}
)",
      cases, fmt::join(names, " "), fmt::join(flags_of(app), " "));
}

}  // namespace

std::string bash_completion(const CLI::App& app) {
  return fmt::format("# taut: what can follow, for bash.\n{}complete -F _taut_words taut\n",
                     completion_function(app));
}

// By zsh's own reader of bash's completions, which takes no compopt.
std::string zsh_completion(const CLI::App& app) {
  return fmt::format(
      R"(#compdef taut
# taut: what can follow, for zsh.
autoload -Uz bashcompinit && bashcompinit
compopt() {{ :; }}
{}local space=()
[[ $words[CURRENT-1] == --set ]] && space=(-o nospace)
_bash_complete $space -F _taut_words
)",
      completion_function(app));
}

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
