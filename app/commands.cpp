#include "commands.hpp"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>

namespace taut {

const Argument& Argument::required() const {
  option_->required();
  return *this;
}

const Argument& Argument::positive() const {
  option_->check(CLI::PositiveNumber);
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
  return Argument(option);
}

template Argument Subcommand::option(const char*, int&, const char*) const;
template Argument Subcommand::option(const char*, long&, const char*) const;
template Argument Subcommand::option(const char*, double&, const char*) const;
template Argument Subcommand::option(const char*, std::string&, const char*) const;
template Argument Subcommand::option(const char*, std::filesystem::path&, const char*) const;
template Argument Subcommand::option(const char*, std::vector<std::string>&, const char*) const;
template Argument Subcommand::option(const char*, std::optional<int>&, const char*) const;
template Argument Subcommand::option(const char*, std::optional<long>&, const char*) const;
template Argument Subcommand::option(const char*, std::optional<double>&, const char*) const;
template Argument Subcommand::option(const char*, std::optional<std::string>&, const char*) const;
template Argument Subcommand::option(const char*, std::optional<std::filesystem::path>&, const char*) const;

Argument Subcommand::flag(const char* name, bool& given, const char* meaning) const {
  return Argument(app_->add_flag(name, given, meaning));
}

struct Commands::Parser {
  CLI::App app;
  std::vector<std::pair<CLI::App*, std::function<void()>>> actions;
};

Commands::Commands(const char* about) : parser_(new Parser{CLI::App{about}, {}}) {
  parser_->app.require_subcommand(1);
}

Commands::~Commands() = default;

Subcommand Commands::add(const char* name, const char* meaning, std::function<void()> action) {
  CLI::App* app = parser_->app.add_subcommand(name, meaning);
  parser_->actions.emplace_back(app, std::move(action));
  return Subcommand(app);
}

int Commands::act(int argc, char** argv) {
  try {
    parser_->app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return parser_->app.exit(e) == 0 ? 0 : 2;
  }
  for (const auto& [app, act] : parser_->actions)
    if (app->parsed()) act();
  return 0;
}

}  // namespace taut
