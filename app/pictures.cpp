#include "pictures.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/wait.h>

#include <cctype>
#include <cstdlib>
#include <map>

#include "command_line.hpp"
#include "files/atomic_file.hpp"
#include "md/errors.hpp"

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

// In double quotes, all that gnuplot could take for its own in octal, which it reads as text and no more.
std::string gnuplot_string(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < ' ')
      quoted += ' ';
    else if (std::isalnum(byte) || byte > 127 || std::string_view(" _.,:;()|/+-=<>").find(c) != text.npos)
      quoted += c;
    else
      quoted += fmt::format("\\{:03o}", byte);
  }
  return quoted + "\"";
}

std::string gnuplot_tic(std::string_view text) {
  std::string label;
  for (const char c : text) label += c == '%' ? std::string("%%") : std::string(1, c);
  return gnuplot_string(label);
}

void StudyFiles::write(const std::string& name, const std::string& text) {
  AtomicFile aside(folder_ / name);
  aside.write(text);
  aside.commit();
  written_.push_back(name);
}

void StudyFiles::draw(const Picture& p) {
  write(p.name + ".csv", p.csv);
  std::error_code ignored;  // of a drawing before this one
  for (const char* kind : {".gp", ".svg", ".png"}) fs::remove(folder_ / (p.name + kind), ignored);
  if (p.script.empty()) return empty_.push_back(p.name);
  write(p.name + ".gp", fmt::format(kPreamble, p.name, p.width, p.height) + p.script + "}\n");
  const int status = std::system(fmt::format("cd -- {} && gnuplot {}.gp >{}.gnuplot.log 2>&1",
                                             quoted_for_shell(fs::absolute(folder_).string()), p.name, p.name)
                                     .c_str());
  const fs::path log = folder_ / (p.name + ".gnuplot.log");
  const bool missing = WIFEXITED(status) && WEXITSTATUS(status) == 127;
  bool drawn = status == 0;
  for (const char* kind : {".svg", ".png"}) {
    const bool there = fs::exists(folder_ / (p.name + kind));
    if (there) written_.push_back(p.name + kind);
    drawn &= there;
  }
  without_gnuplot_ |= missing;
  if (drawn || missing)
    fs::remove(log, ignored);
  else
    undrawn_.push_back(p.name);
}

void StudyFiles::tell() const {
  fmt::print("\nwrote into {}: {}\n", folder_.string(), fmt::join(written_, ", "));
  if (!empty_.empty()) fmt::print("nothing to draw of {}: no setting got through\n", fmt::join(empty_, ", "));
  if (without_gnuplot_)
    fmt::print(
        "no pictures: gnuplot is not installed (Debian: gnuplot-nox); with it, `gnuplot NAME.gp` in {} draws "
        "them\n",
        folder_.string());
  if (undrawn_.empty()) return;
  const std::string& first = undrawn_.front();
  throw OutsideError(
      fmt::format("gnuplot could not draw {}: see {}/{}.gnuplot.log; the figures are in the .csv files",
                  fmt::join(undrawn_, ", "), folder_.string(), first));
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
