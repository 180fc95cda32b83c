#pragma once

#include <fmt/format.h>

#include <string_view>
#include <utility>

namespace taut {

// Everything that the command prints goes through here, so that --quiet and --json hold for all of it. A text
// is written at once: a pipe or a file has each row as soon as it is known. Where standard output does not
// take a text, these functions throw: Stopped if its reader has closed the pipe, OutsideError for a full disk
// and the like.

void print_errors_and_doubts_alone();  // --quiet
void print_json_alone();               // --json, whether or not --quiet is given as well
bool quiet();
bool json_alone();

// Tables and sentences. They are left out under --quiet and --json.
void say_text(std::string_view text);
template <class... Args>
void say(fmt::format_string<Args...> text, Args&&... args) {
  say_text(fmt::format(text, std::forward<Args>(args)...));
}

// What the user is told under --quiet and --json as well. It then goes to standard error.
void say_always(std::string_view text);

// Standard output whatever was asked for: JSON, and the texts of --help and --version.
void write_out(std::string_view text);

// An error, on standard error: "taut: " and the reason.
void complain(std::string_view why);

}  // namespace taut
