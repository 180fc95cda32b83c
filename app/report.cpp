#include "report.hpp"

#include <fmt/format.h>

#include <fstream>
#include <map>

#include "base/threads.hpp"
#include "base/words.hpp"
#include "measures/csv.hpp"
#include "report_page.hpp"

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
  std::vector<std::string> pictures;
  for (const auto& part : page.parts)
    if (!part.picture.empty()) pictures.push_back(part.picture);
  files.draw_all(pictures);
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=en><meta charset=utf-8><title>{0}</title>\n"
      "<meta name=viewport content=\"width=device-width, initial-scale=1\">\n"
      // Nothing is fetched, and nothing that names say is carried out.
      "<meta http-equiv=Content-Security-Policy content=\"default-src 'none'; img-src data:; "
      "style-src 'unsafe-inline'; script-src 'unsafe-inline'\">\n"
      "<style>\n{6}</style>\n"
      "<h1>{0}</h1>\n<p>Made by <code>{1}</code></p>\n"
      "<p class=small>Processor {2}, {3}. Compiler {4}, flags <code>{5}</code>.</p>\n"
      "<p class=small>Charts: a name switches its curve off and on; drag along x to zoom, “whole” goes "
      "back; the pointer reads points.</p>\n"
      "<noscript><p>Charts need scripts; pictures are in files beside this page.</p></noscript>\n",
      escaped(page.title), escaped(page.command), escaped(processor()),
      counted(available_threads(), "thread"), TAUT_COMPILER, TAUT_FLAGS, kReportStyle);
  if (!page.notes.empty()) {
    html += "<ul>\n";
    for (const auto& note : page.notes) html += fmt::format("<li>{}</li>\n", escaped(note));
    html += "</ul>\n";
  }
  for (const auto& part : page.parts) {
    html += fmt::format("<section><h2>{}</h2>\n", escaped(part.title));
    if (!part.text.empty()) html += fmt::format("<p>{}</p>\n", escaped(part.text));
    html += "<div class=charts></div>\n";
    if (!part.picture.empty()) html += inline_svg(files.svg(part.picture)) + "\n";
    for (const auto& line : part.conclusions) html += fmt::format("<p><b>{}</b></p>\n", escaped(line));
    html += fmt::format("<details{}><summary>The figures</summary>\n{}</details></section>\n",
                        part.open ? " open" : "", table_of(part.csv));
  }
  files.write("report.html", fmt::format("{}<script>\n{}</script>\n</html>\n", html, kReportScript));
}

}  // namespace taut
