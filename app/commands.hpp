#pragma once

#include <functional>
#include <memory>
#include <string>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace taut {

// Parses the command line with CLI11. Only commands.cpp includes CLI11, which takes ten seconds to compile.
class Argument {
 public:
  explicit Argument(CLI::Option* option) : option_(option) {}

  const Argument& required() const;
  const Argument& positive() const;
  const Argument& at_least(int least) const;
  const Argument& words(int count, const char* shown) const;  // takes `count` words; the help has `shown`
  // One of these words, "a|b|c"; a list also takes them with commas between them.
  const Argument& one_of(const char* shown) const;
  const Argument& key_values() const { return words(0, "KEY=VALUE"); }  // any number of them
  const Argument& excludes(const Argument& other) const;

 private:
  CLI::Option* option_;
};

class Subcommand {
 public:
  explicit Subcommand(CLI::App* app) : app_(app) {}

  // Adds an option "--steps", or a positional argument "scene". T is a text, path, int, long, double, an
  // optional of these, or a list of texts. The variable's value is the default, which the help shows.
  template <class T>
  Argument option(const char* name, T& value, const char* meaning) const;
  Argument flag(const char* name, bool& given, const char* meaning) const;
  void json(const char* meaning) const;  // --json: the command prints JSON alone (printing.hpp)

 private:
  CLI::App* app_;
};

class Commands {
 public:
  explicit Commands(const char* about);
  ~Commands();

  Subcommand add(const char* name, const char* meaning, std::function<void()> action);

  // Parses the command line and runs the subcommand. Returns the exit code, 2 if the command line is wrong.
  int act(int argc, char** argv);

  std::string help(const std::string& name) const;  // of a subcommand, of taut for ""; empty for no such name

  // Generates completions for "bash" or "zsh", or the "man" page.
  std::string generated(const std::string& what) const;

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
};

// One file per subcommand.
void add_run(Commands& commands);
void add_resume(Commands& commands);
void add_calibrate(Commands& commands);
void add_crosscheck(Commands& commands);
void add_chart(Commands& commands);
void add_stability(Commands& commands);
void add_lists(Commands& commands);
void add_info(Commands& commands);
void add_help(Commands& commands);
void add_measure(Commands& commands);
void add_plot(Commands& commands);
void add_scan(Commands& commands);
void add_generate(Commands& commands);

}  // namespace taut
