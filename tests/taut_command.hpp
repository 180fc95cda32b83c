#pragma once

// The command as a user types it.

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "file_text.hpp"

namespace taut {

// While it exists, commands find no Python and draw nothing, which takes them most of their time.
struct Undrawn {
  Undrawn() { setenv("TAUT_PYTHON", "/nowhere", 1); }
  Undrawn(const Undrawn&) = delete;
  Undrawn& operator=(const Undrawn&) = delete;
  ~Undrawn() { unsetenv("TAUT_PYTHON"); }
};

struct Outcome {
  int exit_code;
  std::string text;  // both streams
};

// `environment`: as a shell takes it before a command, "PATH=/nowhere".
inline Outcome taut(const std::string& arguments, const std::string& environment = "",
                    const std::string& binary = TAUT_BINARY) {
  std::FILE* pipe = popen((environment + " " + binary + " " + arguments + " 2>&1").c_str(), "r");
  Outcome outcome{};
  std::array<char, 4096> buffer;
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe))
    outcome.text.append(buffer.data(), n);
  outcome.exit_code = WEXITSTATUS(pclose(pipe));
  return outcome;
}

// What a command says that ends with this exit code.
inline std::string said(const std::string& arguments, int exit_code = 0) {
  const Outcome outcome = taut(arguments);
  EXPECT_EQ(outcome.exit_code, exit_code) << arguments << "\n" << outcome.text;
  return outcome.text;
}

// A report's text, its entities undone.
inline std::string page(const fs::path& folder) {
  std::string text = contents(folder / "report.html");
  for (const auto& [entity, character] :
       {std::pair("&#39;", '\''), {"&quot;", '"'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&amp;", '&'}})
    for (std::size_t at = 0; (at = text.find(entity, at)) != text.npos; ++at)
      text.replace(at, std::string_view(entity).size(), 1, character);
  return text;
}

// The table below a heading of a report, row by row.
inline std::vector<std::vector<std::string>> page_table(const fs::path& folder, const std::string& heading) {
  std::vector<std::vector<std::string>> rows;
  const std::string text = page(folder);
  std::size_t at = text.find("<h2>" + heading + "</h2>");
  if (at == text.npos) return rows;
  at = text.find("<table>", at);
  const std::size_t end = text.find("</table>", at);
  while ((at = text.find_first_of("<", at + 1)) < end) {
    if (text.compare(at, 4, "<tr>") == 0) rows.emplace_back();
    if (text.compare(at, 4, "<th>") == 0 || text.compare(at, 4, "<td>") == 0)
      rows.back().push_back(text.substr(at + 4, text.find("</t", at) - at - 4));
  }
  return rows;
}

inline int lines(const std::string& text) {
  return static_cast<int>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace taut
