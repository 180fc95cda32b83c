#pragma once

#include <functional>
#include <memory>
#include <string>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace taut {

// What the user types, read by CLI11: behind this file, for it costs whoever includes it ten seconds.
class Argument {
 public:
  explicit Argument(CLI::Option* option) : option_(option) {}

  const Argument& required() const;
  const Argument& positive() const;
  const Argument& at_least(int least) const;
  const Argument& words(int count, const char* shown) const;  // takes so many; in the help they are `shown`
  const Argument& key_values() const { return words(0, "KEY=VALUE"); }  // as many as there are
  const Argument& excludes(const Argument& other) const;

 private:
  CLI::Option* option_;
};

class Subcommand {
 public:
  explicit Subcommand(CLI::App* app) : app_(app) {}

  // "--steps", or "scene" for one without a name. T: text, path, int, long, double, an optional of one of
  // them, a list of texts. The value it has is the default, shown in the help.
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

  // Does what was asked for. Returns the exit code: 2 where that cannot be read.
  int act(int argc, char** argv);

  std::string help(const std::string& name) const;  // of a subcommand, "": of all; empty: there is none

  // From the same description: "bash" or "zsh" completes what is typed, "man" is the page.
  std::string generated(const std::string& what) const;

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
};

// A file a subcommand.
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
void add_generate(Commands& commands);

}  // namespace taut
