#include "commands.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <sstream>

#include "generated.hpp"
#include "md/errors.hpp"
#include "md/nearest_name.hpp"
#include "md/threads.hpp"
#include "words.hpp"

namespace taut {

const Argument& Argument::required() const {
  option_->required();
  return *this;
}

// CLI11's own say what they expect by numbers of 309 digits.
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

const Argument& Argument::excludes(const Argument& other) const {
  option_->excludes(other.option_);
  return *this;
}

template <class T>
Argument Subcommand::option(const char* name, T& value, const char* meaning) const {
  CLI::Option* option = app_->add_option(name, value, meaning);
  if (value != T{}) option->capture_default_str();
  if constexpr (std::is_same_v<T, std::filesystem::path> ||
                std::is_same_v<T, std::optional<std::filesystem::path>>)
    option->type_name("PATH");
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

namespace {

// As wide as the terminal, and without what usage and words say: "REQUIRED", "x 2", "Excludes: --overwrite".
class HelpFormat : public CLI::Formatter {
 public:
  std::string make_description(const CLI::App* app) const override {
    return fitted(app->get_description(), 0) + "\n";
  }
  std::string make_option_opts(const CLI::Option* option) const override {
    if (option->get_type_size() == 0) return "";
    const std::string unless = option->get_default_str();
    const bool many = option->get_expected_max() == CLI::detail::expected_max_vector_size;
    return fmt::format(" {}{}{}", option->get_type_name(), unless.empty() ? "" : "=" + unless,
                       many ? " ..." : "");
  }
  std::string make_option_desc(const CLI::Option* option) const override {
    return fitted(option->get_description(), kColumn);
  }
  std::string make_subcommand(const CLI::App* sub) const override {
    std::ostringstream out;
    CLI::detail::format_help(out, sub->get_name(), fitted(sub->get_description(), kColumn), kColumn);
    return out.str();
  }

 private:
  static constexpr int kColumn = 30;  // CLI11's own
  static std::string fitted(const std::string& text, int column) {
    return wrapped(text, std::min(terminal_width(), 100) - column, 0);
  }
};

}  // namespace

struct Commands::Parser {
  CLI::App app;
  std::vector<std::pair<CLI::App*, std::function<void()>>> actions;
  std::optional<int> threads;
  bool quiet = false;
};

namespace {

constexpr int kMostThreads = 1024;
bool be_quiet = false;

const CLI::App* named(const CLI::App& app, const std::string& name) {
  const auto found = app.get_subcommands([&](const CLI::App* sub) { return sub->get_name() == name; });
  return name.empty() || found.empty() ? nullptr : found[0];
}

// What was typed for a subcommand and is none; empty: nothing was.
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

// One line: what cannot be read, and what was meant.
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
  }
  return fmt::format("{}{} (taut {}{}--help)", before, what, name, name.empty() ? "" : " ");
}

}  // namespace

bool quiet() {
  return be_quiet;
}

Commands::Commands(const char* about) : parser_(new Parser{CLI::App{about}, {}, {}}) {
  CLI::App& app = parser_->app;
  app.name("taut");
  app.formatter(std::make_shared<HelpFormat>());
  app.require_subcommand(1);
  app.set_version_flag("--version", "taut " TAUT_VERSION);
  const Subcommand root(&app);
  root.option("--threads", parser_->threads, "so many compute (if not said: OMP_NUM_THREADS, or 1)")
      .at_least(1);
  root.flag("--quiet", parser_->quiet, "print errors and doubts alone");
}

Commands::~Commands() = default;

Subcommand Commands::add(const char* name, const char* meaning, std::function<void()> action) {
  CLI::App* app = parser_->app.add_subcommand(name, meaning);
  app->fallthrough();  // --threads may stand behind as well
  parser_->actions.emplace_back(app, std::move(action));
  return Subcommand(app);
}

int Commands::act(int argc, char** argv) {
  CLI::App& app = parser_->app;
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);
    throw InputError(complaint(app, e, argc, argv));
  }
  if (parser_->threads) {
    if (*parser_->threads > kMostThreads)
      throw InputError(
          fmt::format("--threads: expected at most {}, got {}", kMostThreads, *parser_->threads));
    const std::string asked = std::to_string(*parser_->threads);
    setenv("OMP_NUM_THREADS", asked.c_str(), 1);  // as if said there: what goes on keeps to it, too
    use_threads(*parser_->threads);
    if (available_threads() != *parser_->threads)
      throw InputError("--threads: this taut was built without OpenMP and computes with one");
  }
  be_quiet = parser_->quiet;
  if (be_quiet && !std::freopen("/dev/null", "w", stdout)) throw OutsideError("/dev/null: cannot be opened");
  for (const auto& [sub, act] : parser_->actions)
    if (sub->parsed()) act();
  return 0;
}

// App::help() would tell of what was parsed.
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
