#include "pictures.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/wait.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "base/errors.hpp"
#include "command_line.hpp"
#include "files/atomic_file.hpp"
#include "files/resources.hpp"
#include "printing.hpp"
#include "stop_request.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

// Exit codes: of gnuplot, of a script that has no rows to draw, of a shell without gnuplot, and of Ctrl-C.
constexpr int kDrawn = 0, kNothingToDraw = 4, kNoGnuplot = 127, kInterrupted = 128 + SIGINT;

int run_gnuplot(const fs::path& folder, const std::string& name) {
  const int status = std::system(fmt::format("cd -- {} && gnuplot {}.gp >{}.gnuplot.log 2>&1",
                                             quoted_for_shell(fs::absolute(folder).string()), name, name)
                                     .c_str());
  const int code = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  if (code == kInterrupted) throw Stopped{code};  // Ctrl-C, which std::system hides from this process
  return code;
}

// Returns a cell for a file separated by tabs; gnuplot takes a double quote for its end.
std::string tsv_cell(std::string text) {
  std::ranges::replace(text, '"', '\'');
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < ' '; }, ' ');
  return text;
}

}  // namespace

std::string contents_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

void StudyFiles::write(const std::string& name, const std::string& text) {
  AtomicFile aside(folder_ / name);
  aside.write(text);
  aside.commit();
  if (std::ranges::find(written_, name) == written_.end()) written_.push_back(name);
}

void StudyFiles::draw(const Picture& p) {
  const fs::path scripts = resource_folder("pictures");
  titles_ += fmt::format("{}\t{}\n", p.name, tsv_cell(p.title));
  write("titles.tsv", titles_);
  write(p.name + ".csv", p.csv);
  for (const std::string& script : {std::string("taut.gp"), p.name + ".gp"})
    write(script, contents_of(scripts / script));
  std::error_code ignored;  // a picture of an earlier run
  for (const char* kind : {".svg", ".png"}) fs::remove(folder_ / (p.name + kind), ignored);
  const int status = run_gnuplot(folder_, p.name);
  bool drawn = status == kDrawn;
  for (const char* kind : {".svg", ".png"}) {
    const bool there = fs::exists(folder_ / (p.name + kind));
    if (there) written_.push_back(p.name + kind);
    drawn &= there;
  }
  without_gnuplot_ |= status == kNoGnuplot;
  if (status == kNothingToDraw) empty_.push_back(p.name);
  if (drawn || status == kNoGnuplot || status == kNothingToDraw)
    fs::remove(folder_ / (p.name + ".gnuplot.log"), ignored);
  else
    undrawn_.push_back(p.name);
}

void StudyFiles::print_written() const {
  say("\nwrote into {}: {}\n", folder_.string(), fmt::join(written_, ", "));
  if (!empty_.empty()) say("nothing to draw of {}: no setting got through\n", fmt::join(empty_, ", "));
  if (without_gnuplot_)
    say("no pictures: gnuplot is not installed (Debian: gnuplot-nox); with it, `gnuplot NAME.gp` in {} draws "
        "them\n",
        folder_.string());
  if (undrawn_.empty()) return;
  const std::string& first = undrawn_.front();
  throw OutsideError(
      fmt::format("gnuplot could not draw {}: see {}/{}.gnuplot.log; the figures are in the .csv files",
                  fmt::join(undrawn_, ", "), folder_.string(), first));
}

}  // namespace taut
