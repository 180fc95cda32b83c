#include "pictures.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <map>

#include "command_line.hpp"
#include "md/aside_file.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPreamble =
    R"(# Draws {0}.svg and {0}.png from {0}.csv: `gnuplot {0}.gp` in this folder.
csv = '{0}.csv'
set encoding utf8
do for [kind in 'svg png'] {{
  reset
  set datafile separator ','
  set datafile columnheaders
  if (kind eq 'svg') {{
    set terminal svg size {1},{2} background 'white' font 'Helvetica,12'
  }} else {{
    set terminal pngcairo size {1},{2} background 'white' font 'Helvetica,11'
  }}
  set output '{0}.'.kind
  set grid lc rgb '#dddddd' lt 1
  set border lw 0.8
  set tics nomirror
)";

}  // namespace

void write_text(const fs::path& file, const std::string& text) {
  AsideFile aside(file);
  aside.write(text);
  aside.commit();
}

bool draw(const Picture& p, const fs::path& folder) {
  write_text(folder / (p.name + ".csv"), p.csv);
  write_text(folder / (p.name + ".gp"), fmt::format(kPreamble, p.name, p.width, p.height) + p.script + "}\n");
  if (std::system("command -v gnuplot >/dev/null 2>&1") != 0) {
    fmt::print("no picture: gnuplot is not installed (gnuplot-nox); the script is {}/{}.gp\n",
               folder.string(), p.name);
    return false;
  }
  const std::string command =
      fmt::format("cd -- {} && gnuplot {}.gp >gnuplot.log 2>&1", quoted_for_shell(folder.string()), p.name);
  if (std::system(command.c_str()) != 0) {
    fmt::print("gnuplot stopped at {}.gp: see {}/gnuplot.log\n", p.name, folder.string());
    return false;
  }
  fs::remove(folder / "gnuplot.log");
  return true;
}

// Okabe and Ito's colours, which the colour-blind tell apart too; marks for black and white.
std::string mark_of(const std::string& method) {
  static const std::map<std::string, const char*> kMarks = {
      {"baumgarte", "lc rgb '#D55E00' pt 7"}, {"feedforward", "lc rgb '#000000' pt 5"},
      {"shake", "lc rgb '#56B4E9' pt 8"},     {"rattle", "lc rgb '#0072B2' pt 9"},
      {"newton", "lc rgb '#009E73' pt 13"},   {"lincs", "lc rgb '#CC79A7' pt 12"},
      {"settle", "lc rgb '#E69F00' pt 11"},   {"penalty", "lc rgb '#8C564B' pt 4"},
      {"none", "lc rgb '#999999' pt 6"}};
  const auto at = kMarks.find(method);
  return at != kMarks.end() ? at->second : "lc rgb '#555555' pt 2";
}

}  // namespace taut
