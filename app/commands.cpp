#include "commands.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <sstream>

#include "base/errors.hpp"
#include "base/nearest_name.hpp"
#include "base/threads.hpp"
#include "base/words.hpp"
#include "constraints/registry.hpp"
#include "generated.hpp"
#include "printing.hpp"

namespace taut {
namespace {

bool takes_many(const CLI::Option& option) {
  return option.get_expected_max() == CLI::detail::expected_max_vector_size;
}

// Whether a word, or each part of "a,c", is one of "a|b|c".
bool is_one_of(const std::string& shown, const std::string& given) {
  return std::ranges::all_of(CLI::detail::split(given, ','), [&](const std::string& part) {
    return std::ranges::count(CLI::detail::split(shown, '|'), part) > 0;
  });
}

}  // namespace

const Argument& Argument::required() const {
  option_->required();
  return *this;
}

// Error messages for numbers, because CLI11's own print limits with 309 digits.
const Argument& Argument::positive() const {
  option_->check(CLI::Validator(
      [](const std::string& given) {
        double number = 0;
        const bool good = CLI::detail::lexical_cast(given, number) && number > 0;
        return good ? std::string() : "expected more than 0, got " + given;
      },
      ""));
  return *this;
}

const Argument& Argument::at_least(int least) const {
  option_->check(CLI::Validator(
      [least](const std::string& given) {
        int number = 0;
        const bool good = CLI::detail::lexical_cast(given, number) && number >= least;
        return good ? std::string()
                    : fmt::format("expected a whole number of at least {}, got {}", least, given);
      },
      ""));
  return *this;
}

const Argument& Argument::words(int count, const char* shown) const {
  if (count > 0) option_->expected(count);
  option_->type_name(shown);
  return *this;
}

const Argument& Argument::one_of(const char* shown) const {
  option_->type_name(shown);
  if (takes_many(*option_)) option_->delimiter(',');
  option_->check(CLI::Validator(
      [shown](const std::string& given) {
        return is_one_of(shown, given) ? std::string() : fmt::format("expected {}, got {}", shown, given);
      },
      ""));
  return *this;
}

const Argument& Argument::excludes(const Argument& other) const {
  option_->excludes(other.option_);
  return *this;
}

namespace {

// Accepts any number without a fraction as an integer, e.g. 1e6, as scenes do. CLI11 would take the largest integer for
// a number beyond it.
std::string as_integer(std::string& text) {
  double number = 0;
  if (!CLI::detail::lexical_cast(text, number)) return "";
  if (number != std::floor(number)) return "expected a whole number, got " + text;
  if (std::abs(number) >= 0x1p63) return "expected a whole number below 9.2e18, got " + text;
  if (text.find_first_of(".eE") != text.npos) text = fmt::format("{:.0f}", number);
  return "";
}

template <class T>
constexpr bool is_integer = std::is_same_v<T, int> || std::is_same_v<T, long> ||
                            std::is_same_v<T, std::optional<int>> || std::is_same_v<T, std::optional<long>>;

}  // namespace

template <class T>
Argument Subcommand::option(const char* name, T& value, const char* meaning) const {
  CLI::Option* option = app_->add_option(name, value, meaning);
  if constexpr (is_integer<T>) option->transform(CLI::Validator(as_integer, ""));
  if (!option->get_positional())
    option->allow_extra_args(false);  // separate_lists() separates the words of a list
  if (value != T{}) option->capture_default_str();
  if constexpr (std::is_same_v<T, std::filesystem::path> ||
                std::is_same_v<T, std::optional<std::filesystem::path>>) {
    option->type_name("PATH");
    option->check(CLI::Validator(
        [](const std::string& given) {
          return given.empty() ? std::string("expected a path, got an empty one") : std::string();
        },
        ""));
  }
  return Argument(option);
}

template Argument Subcommand::option(const char*, int&, const char*) const;
template Argument Subcommand::option(const char*, long&, const char*) const;
template Argument Subcommand::option(const char*, double&, const char*) const;
template Argument Subcommand::option(const char*, std::string&, const char*) const;
template Argument Subcommand::option(const char*, std::filesystem::path&, const char*) const;
template Argument Subcommand::option(const char*, std::vector<std::string>&, const char*) const;
template Argument Subcommand::option(const char*, std::vector<double>&, const char*) const;
template Argument Subcommand::option(const char*, std::optional<int>&, const char*) const;
template Argument Subcommand::option(const char*, std::optional<long>&, const char*) const;
template Argument Subcommand::option(const char*, std::optional<double>&, const char*) const;
template Argument Subcommand::option(const char*, std::optional<std::string>&, const char*) const;
template Argument Subcommand::option(const char*, std::optional<std::filesystem::path>&, const char*) const;

Argument Subcommand::flag(const char* name, bool& given, const char* meaning) const {
  return Argument(app_->add_flag(name, given, meaning));
}

void Subcommand::json(const char* meaning) const {
  app_->add_flag_callback("--json", print_json_alone, meaning);
}

namespace {

// A formatter for help as wide as the terminal, without CLI11's "REQUIRED", "x 2" and "Excludes:
// --overwrite", which usage and descriptions say already.
class HelpFormat : public CLI::Formatter {
 public:
  std::string make_description(const CLI::App* app) const override {
    return wrapped(app->get_description(), std::min(terminal_width(), 100), 0) + "\n";
  }
  std::string make_option_opts(const CLI::Option* option) const override {
    if (option->get_type_size() == 0) return "";
    const std::string unless = option->get_default_str();
    return fmt::format(" {}{}{}", option->get_type_name(), unless.empty() ? "" : "=" + unless,
                       takes_many(*option) ? " ..." : "");
  }
  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    return in_columns(make_option_name(option, is_positional) + make_option_opts(option),
                      option->get_description());
  }
  std::string make_subcommand(const CLI::App* sub) const override {
    return in_columns(sub->get_name(), sub->get_description());
  }

 private:
  // Versions of CLI11 differ in how they do this.
  static std::string in_columns(const std::string& name, const std::string& meaning) {
    constexpr int kColumn = 30;
    const std::string left = "  " + name;
    const bool below = left.size() >= kColumn && !meaning.empty();
    return fmt::format("{}{:<{}}{}\n", below ? left + "\n" : "", below ? "" : left,
                       meaning.empty() ? 0 : kColumn,
                       wrapped(meaning, std::min(terminal_width(), 100), kColumn));
  }
};

}  // namespace

struct Commands::Parser {
  CLI::App app;
  std::vector<std::pair<CLI::App*, std::function<void()>>> actions;
  std::optional<std::string> threads;  // a number, or "auto"
};

namespace {

const CLI::App* named(const CLI::App& app, const std::string& name) {
  const auto found = app.get_subcommands([&](const CLI::App* sub) { return sub->get_name() == name; });
  return name.empty() || found.empty() ? nullptr : found[0];
}

bool is_list(const CLI::Option& option) {
  return !option.get_positional() && takes_many(option);
}

// True if a word can belong to a list of that type. The first word of a list always does.
bool can_be_in_list(const std::string& type, const std::string& word) {
  if (type == "KEY=VALUE") return word.find('=') != word.npos;
  if (type == "METHOD") return std::ranges::count(method_names(), word.substr(0, word.find(':'))) > 0;
  if (type.find('|') != type.npos) return is_one_of(type, word);
  double number = 0;
  return type != "NUMBER" || CLI::detail::lexical_cast(word, number);
}

// CLI11 assigns every word up to the next option to a list, including the scene. Therefore each further word
// of a list gets the option's name before it, as in `--set a=1 --set b=2`, and a word that cannot belong to
// the list stands alone.
std::vector<std::string> separate_lists(const CLI::App& app, int argc, char** argv) {
  std::vector<std::string> words;
  const CLI::App* sub = nullptr;
  const CLI::Option* list = nullptr;
  bool first = false;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    if (word == "--") {
      words.insert(words.end(), argv + k, argv + argc);
      break;
    }
    if (!sub) sub = named(app, word);
    if (word.starts_with("--")) {
      const std::string name = word.substr(0, word.find('='));
      list = sub ? sub->get_option_no_throw(name) : nullptr;
      if (list && !is_list(*list)) list = nullptr;
      first = name == word;
    } else if (list) {
      if (!first && can_be_in_list(list->get_type_name(), word)) words.push_back(list->get_name());
      first = false;
    }
    words.push_back(word);
  }
  std::ranges::reverse(words);  // the order that CLI11 expects
  return words;
}

// Returns the word typed in place of a subcommand, or an empty string.
std::string unknown_subcommand(const CLI::App& app, int argc, char** argv) {
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    if (word == "--threads") ++k;
    if (word.starts_with("-")) continue;
    return named(app, word) ? "" : word;
  }
  return "";
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    if (!option->get_lnames().empty()) names.push_back("--" + option->get_lnames()[0]);
  return names;
}

// Returns one line that says what cannot be parsed, and the nearest valid word.
std::string complaint(const CLI::App& app, const CLI::ParseError& e, int argc, char** argv) {
  if (const std::string typed = unknown_subcommand(app, argc, argv); !typed.empty()) {
    std::vector<std::string_view> names;
    for (const CLI::App* sub : app.get_subcommands({})) names.emplace_back(sub->get_name());
    return fmt::format("there is no command \"{}\"{}", typed, did_you_mean(typed, names));
  }
  const auto parsed = app.get_subcommands();
  const std::string name = parsed.empty() ? "" : parsed[0]->get_name();
  const std::string before = name.empty() ? "" : name + ": ";
  std::string what = e.what();
  std::ranges::replace(what, '\n', ' ');
  if (dynamic_cast<const CLI::ConversionError*>(&e))  // "Could not convert: --steps = two"
    what = fmt::format("expected a number{}", what.substr(std::min(what.find(": "), what.size())));
  if (dynamic_cast<const CLI::ExtrasError*>(&e)) {
    std::vector<std::string> names = option_names(app);
    if (!parsed.empty()) std::ranges::copy(option_names(*parsed[0]), std::back_inserter(names));
    for (const std::string& extra : app.remaining(true))
      if (const std::string option = extra.substr(0, extra.find('=')); option.starts_with("--"))
        if (const auto near = nearest_name(option, {names.begin(), names.end()}); !near.empty())
          return fmt::format("{}there is no option {}; did you mean {}?", before, option, near);
    for (const std::string& extra : app.remaining(true))
      if (const auto near = nearest_name(extra, method_names()); !near.empty() && !parsed.empty())
        return fmt::format("{}there is no method \"{}\"; did you mean \"{}\"?", before, extra, near);
    const std::vector<std::string> extras = app.remaining(true);
    const CLI::Option* scene = parsed.empty() ? nullptr : parsed[0]->get_option_no_throw("scene");
    if (scene && scene->count() > 0 && !extras.empty() && !extras[0].starts_with("-"))
      return fmt::format("{}there is no place for \"{}\": the scene is \"{}\"", before, extras[0],
                         scene->results()[0]);
  }
  return fmt::format("{}{} (taut {}{}--help)", before, what, name, name.empty() ? "" : " ");
}

void take_threads(const std::string& said) {
  if (said == "auto") return ignore_omp_num_threads();
  double threads = 0;  // written as numbers in scenes are, 2.0 as well
  if (!CLI::detail::lexical_cast(said, threads) || threads != std::trunc(threads) ||
      !(std::abs(threads) < 1e9))
    throw InputError(fmt::format("--threads {}: expected a whole number, or auto", said));
  expect_threads("--threads", static_cast<int>(threads));
  use_threads(static_cast<int>(threads));
}

}  // namespace

Commands::Commands(const char* about) : parser_(new Parser{CLI::App{about}, {}, {}}) {
  CLI::App& app = parser_->app;
  app.name("taut");
  app.formatter(std::make_shared<HelpFormat>());
  app.require_subcommand(1);
  app.set_version_flag("--version", "taut " TAUT_VERSION);
  const Subcommand root(&app);
  root.option("--threads", parser_->threads,
              "so many compute; `auto`: `run` takes the cores that the process may use, one for every 1000 "
              "atoms at most, other commands one (if not said: OMP_NUM_THREADS, or auto)")
      .words(0, "NUMBER");
  app.add_flag_callback("--quiet", print_errors_and_doubts_alone, "print errors and doubts alone");
}

Commands::~Commands() = default;

Subcommand Commands::add(const char* name, const char* meaning, std::function<void()> action) {
  CLI::App* app = parser_->app.add_subcommand(name, meaning);
  app->fallthrough();  // --threads may follow the subcommand
  parser_->actions.emplace_back(app, std::move(action));
  return Subcommand(app);
}

int Commands::act(int argc, char** argv) {
  CLI::App& app = parser_->app;
  try {
    app.parse(separate_lists(app, argc, argv));
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) {
      std::ostringstream text;
      app.exit(e, text, text);
      write_out(text.str());
      return 0;
    }
    throw InputError(complaint(app, e, argc, argv));
  }
  if (parser_->threads) take_threads(*parser_->threads);
  default_threads();  // refuses an invalid OMP_NUM_THREADS before any file is made
  for (const auto& [sub, act] : parser_->actions)
    if (sub->parsed()) act();
  return 0;
}

// App::help() depends on what was parsed.
std::string Commands::help(const std::string& name) const {
  const CLI::App* app = name.empty() ? &parser_->app : named(parser_->app, name);
  return app ? app->get_formatter()->make_help(app, name.empty() ? "taut" : "taut " + name,
                                               CLI::AppFormatMode::Normal)
             : "";
}

std::string Commands::generated(const std::string& what) const {
  const CLI::App& app = parser_->app;
  return what == "man" ? man_page(app) : what == "zsh" ? zsh_completion(app) : bash_completion(app);
}

}  // namespace taut
