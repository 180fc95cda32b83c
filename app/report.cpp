#include "report.hpp"

#include <fmt/format.h>

#include <fstream>
#include <map>

#include "base/threads.hpp"
#include "base/words.hpp"
#include "measures/csv.hpp"

namespace taut {
namespace {

std::string escaped(const std::string& text) {
  static const std::map<char, const char*> kEntities = {
      {'<', "&lt;"}, {'>', "&gt;"}, {'&', "&amp;"}, {'"', "&quot;"}, {'\'', "&#39;"}};
  std::string out;
  for (const char c : text) {
    const auto entity = kEntities.find(c);
    out += entity != kEntities.end() ? entity->second : std::string(1, c);
  }
  return out;
}

std::string table_of(const std::string& csv) {
  std::string text = "<div class=scroll><table>\n", tag = "th";
  for (const auto& row : csv_rows(csv)) {
    text += "<tr>";
    for (const auto& cell : row) text += fmt::format("<{0}>{1}</{0}>", tag, escaped(cell));
    text += "</tr>\n";
    tag = "td";
  }
  return text + "</table></div>\n";
}

std::string processor() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown";
}

// Returns the SVG from "<svg" on, because the XML header must not stand inside a page.
std::string inline_svg(const std::string& text) {
  const auto start = text.find("<svg");
  return start == text.npos ? "<p>(not drawn)</p>" : text.substr(start);
}

}  // namespace

void write_report(const ReportPage& page, StudyFiles& files) {
  files.draw_all(true);
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=en><meta charset=utf-8><title>{0}</title>\n"
      "<style>body{{font:16px/1.5 sans-serif;max-width:60em;margin:2em auto;padding:0 1em;color:#222}}"
      "svg{{max-width:100%;height:auto}}table{{border-collapse:collapse;font-size:12px}}"
      "td,th{{padding:1px 8px;border-bottom:1px solid #ddd;text-align:left}}"
      ".scroll{{max-height:24em;overflow:auto}}code{{background:#f3f3f3;padding:2px 4px}}</style>\n"
      "<h1>{0}</h1>\n<p>Made by <code>{1}</code></p>\n"
      "<p>Processor {2}, {3}. Compiler {4}, flags <code>{5}</code>.</p>\n",
      escaped(page.title), escaped(page.command), escaped(processor()),
      counted(available_threads(), "thread"), TAUT_COMPILER, TAUT_FLAGS);
  if (!page.notes.empty()) {
    html += "<ul>\n";
    for (const auto& note : page.notes) html += fmt::format("<li>{}</li>\n", escaped(note));
    html += "</ul>\n";
  }
  for (const auto& part : page.parts) {
    html += fmt::format("<h2>{}</h2>\n", escaped(part.title));
    if (!part.text.empty()) html += fmt::format("<p>{}</p>\n", escaped(part.text));
    if (!part.picture.empty()) html += inline_svg(files.svg(part.picture)) + "\n";
    for (const auto& line : part.conclusions) html += fmt::format("<p><b>{}</b></p>\n", escaped(line));
    html += fmt::format("<details{}><summary>The figures</summary>\n{}</details>\n", part.open ? " open" : "",
                        table_of(part.csv));
  }
  files.write("report.html", html + "</html>\n");
}

}  // namespace taut
