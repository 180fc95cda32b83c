// Pictures of a crosscheck: data, the gnuplot script and what it makes of them, so that anyone can redraw
// them.

#include <fmt/format.h>

#include <cstdlib>

#include "crosscheck_report.hpp"
#include "md/aside_file.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

bool ran(const Track& track) {
  return track.samples.size() > 1;
}

// A gnuplot column of crosscheck.csv, for one run only.
std::string curve(const Track& track, const std::string& column) {
  return fmt::format(
      "csv using (strcol('run') eq '{0}' ? column('t_ps') : 1/0):(column('{1}') > 0 ? column('{1}') : 1/0) "
      "with lines title '{0}'",
      track.name, column);
}

std::string plot(const Crosscheck& c, const std::string& column, bool with_twin) {
  std::string text = "plot ";
  if (with_twin) text += curve(c.twin, column) + ", \\\n     ";
  text += curve(c.nudged, column) + " dashtype 2, \\\n     " + curve(c.verlet, column) + " dashtype 2";
  for (const Track& track : c.tracks)
    if (ran(track)) text += ", \\\n     " + curve(track, column);
  return text + "\n";
}

std::string picture(const std::string& name, const std::string& title, const std::string& ylabel,
                    const std::string& plotted) {
  return fmt::format("set output '{}.svg'\nset title '{}'\nset ylabel '{}'\n{}\n", name, title, ylabel,
                     plotted);
}

std::string energies(const Crosscheck& c) {
  const auto shifted = [](const Track& track) {
    return fmt::format(
        "csv using (strcol('run') eq '{0}' ? column('t_ps') : 1/0):(column('energy_kj_mol') - {1:.12g}) "
        "with lines title '{0}'",
        track.name, track.samples.front().energy);
  };
  std::string text = "unset logscale y\nset format y '%g'\nplot " + shifted(c.twin);
  for (const Track& track : c.tracks)
    if (ran(track)) text += ", \\\n     " + shifted(track);
  return text + "\n";
}

std::string distances_csv(const Crosscheck& c) {
  std::string text = "run,r_nm,g,standard_error\n";
  const auto add = [&](const Track& track) {
    for (std::size_t n = 0; n < track.oxygens.r.size(); ++n)
      text += fmt::format("{},{:.4f},{:.6f},{:.6f}\n", track.name, track.oxygens.r[n],
                          track.oxygens.g[n].value, track.oxygens.g[n].error);
  };
  add(c.twin);
  for (const Track& track : c.tracks) add(track);
  return text;
}

std::string distances(const Crosscheck& c) {
  const auto curve_of = [](const Track& track, const char* style) {
    return fmt::format(
        "'distances.csv' using (strcol('run') eq '{0}' ? column('r_nm') : 1/0):'g':'standard_error' "
        "with {1} title '{0}'",
        track.name, style);
  };
  std::string text = "set xlabel 'r [nm]'\nplot " + curve_of(c.twin, "yerrorlines");
  for (const Track& track : c.tracks)
    if (!track.oxygens.r.empty()) text += ", \\\n     " + curve_of(track, "lines");
  return text + "\n";
}

void write(const fs::path& path, const std::string& text) {
  AsideFile file(path);
  file.write(text);
  file.commit();
}

}  // namespace

void draw_crosscheck(const Crosscheck& c, const fs::path& folder) {
  std::string script = fmt::format(
      "# {}: drawn from crosscheck.csv by `gnuplot crosscheck.gp` in this folder\n"
      "csv = 'crosscheck.csv'\nset datafile separator ','\nset datafile columnheaders\n"
      "set terminal svg size 900,540 background 'white'\nset key outside right\nset grid\n"
      "set xlabel 't [ps]'\nset logscale y\nset format y '10^{{%L}}'\n\n",
      c.scene);
  script += fmt::format("set xrange [0:{:g}]\n", static_cast<double>(c.parting) * c.h);
  script += picture("apart", c.scene + ": apart from OpenMM''s run", "largest distance [nm]",
                    plot(c, "apart_nm", false));
  script += picture("fine", c.scene + ": apart from the fine run", "largest distance [nm]",
                    plot(c, "from_fine_run_nm", true));
  script += "set xrange [0:*]\n";
  script += picture("bonds", c.scene + ": bond errors", "largest relative error",
                    plot(c, "max_rel_bond_error", true));
  script += picture("energy", c.scene + ": total energy", "E − E_0 [kJ/mol]", energies(c));
  if (!c.twin.oxygens.r.empty()) {
    write(folder / "distances.csv", distances_csv(c));
    script += picture("distances", c.scene + ": O–O radial distribution", "g(r)", distances(c));
  }
  write(folder / "crosscheck.gp", script);
  if (std::system("command -v gnuplot >/dev/null 2>&1") != 0) {
    fmt::print("no pictures: gnuplot is not installed (gnuplot-nox); the script is {}/crosscheck.gp\n",
               folder.string());
    return;
  }
  const std::string command = fmt::format("cd '{}' && gnuplot crosscheck.gp 2>gnuplot.log", folder.string());
  if (std::system(command.c_str()) != 0)
    fmt::print("gnuplot stopped: see {}/gnuplot.log\n", folder.string());
  else
    fs::remove(folder / "gnuplot.log");
}

}  // namespace taut
