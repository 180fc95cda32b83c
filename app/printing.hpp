#pragma once

#include <fmt/format.h>

#include <nlohmann/json_fwd.hpp>
#include <string_view>
#include <utility>

namespace taut {

// All output of the command goes through these functions, so that --quiet and --json apply to all of it. Text
// is written at once: a pipe or a file gets each row immediately. If standard output fails, they throw
// Stopped if its reader has closed the pipe, and OutsideError otherwise, e.g. for a full disk.

void print_errors_and_doubts_alone();  // --quiet
void print_json_alone();               // --json, with or without --quiet
bool quiet();
bool json_alone();
int terminal_width();  // COLUMNS, or stdout's up to 120; unlimited if that is no terminal

// Prints tables and sentences. --quiet and --json omit them.
void say_text(std::string_view text);
template <class... Args>
void say(fmt::format_string<Args...> text, Args&&... args) {
  say_text(fmt::format(text, std::forward<Args>(args)...));
}

// Prints messages that --quiet and --json do not omit; with them it goes to standard error.
void say_always(std::string_view text);

// Prints to standard output in any case: JSON, and the texts of --help and --version.
void write_out(std::string_view text);
void write_json(const nlohmann::ordered_json& json);

// Prints an error on standard error: "taut: " and the reason.
void complain(std::string_view why);

}  // namespace taut
