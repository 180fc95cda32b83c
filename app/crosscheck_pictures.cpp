#include <fmt/format.h>

#include "crosscheck_report.hpp"
#include "studies/csv.hpp"

namespace taut {
namespace {

// A curve a run: a method's in its own colour and mark, its further settings and OpenMM's runs dashed.
struct Curve {
  const Track* track;
  std::string style;
};

std::vector<Curve> curves_of(const Crosscheck& c) {
  std::vector<Curve> curves;
  for (const Track* openmm : {&c.twin, &c.verlet, &c.nudged})
    curves.push_back(
        {openmm, fmt::format("lc rgb '#777777' dt {} lw 1.5 pt {}", curves.size() + 1, curves.size() + 1)});
  std::string before;
  int dash = 1;
  for (const Track& track : c.tracks) {
    if (track.samples.size() < 2) continue;
    const std::string method = track.name.substr(0, track.name.find(' '));
    dash = method == before ? dash + 1 : 1;
    before = method;
    curves.push_back({&track, fmt::format("{} dt {} lw 1.5 ps 0.7", mark_of(method), dash)});
  }
  return curves;
}

struct Panel {
  std::string title, ylabel, column;
  bool from_twin = true;    // distances of the twin from itself are none
  bool from_start = false;  // what it has moved by since
};

std::string panel_of(const Crosscheck& c, const Panel& panel, bool with_key) {
  std::string text = fmt::format("  set title {}\n  set ylabel {}\n  plot ", gnuplot_string(panel.title),
                                 gnuplot_string(panel.ylabel));
  const char* separator = "";
  for (const auto& [track, style] : curves_of(c)) {
    if (track == &c.twin && !panel.from_twin) continue;
    const double start = panel.from_start ? track->samples.front().energy : 0;
    text += fmt::format(
        "{}csv using (strcol('run') eq {} ? column('t_ps') : 1/0):(seen(column('{}') - {:.12g})) with "
        "linespoints pi -8 {} "
        "{}",
        separator, gnuplot_string(track->name), panel.column, start, style,
        with_key ? fmt::format("title {}", gnuplot_string(track->name)) : "notitle");
    separator = ", \\\n       ";
  }
  return text + "\n";
}

Picture runs_picture(const Crosscheck& c, const std::string& csv) {
  Picture p{"crosscheck", csv, "", 1000, 860};
  p.script = fmt::format(
      "  set multiplot layout 2,2 title {} noenhanced margins "
      "0.08,0.98,0.2,0.92 "
      "spacing 0.1,0.1\n"
      "  set xlabel 't [ps]'\n  set key noenhanced at screen 0.5,0.005 center bottom maxrows 4 samplen 3 "
      "width 1\n"
      "  set xrange [0:{:g}]\n  set logscale y\n  set format y '10^{{%L}}'\n  seen(y) = y != 0 ? abs(y) : "
      "1/0\n",
      gnuplot_string(fmt::format("{}: taut against OpenMM {}, {}", c.scene, c.openmm, c.platform)),
      static_cast<double>(c.parting) * c.h);
  p.script += panel_of(c, {"apart from OpenMM's run", "largest distance [nm]", "apart_nm", false}, false);
  p.script += panel_of(c, {"apart from the fine run", "largest distance [nm]", "from_fine_run_nm"}, true);
  p.script += "  unset key\n  set xrange [0:*]\n";
  p.script += panel_of(c, {"bond errors", "largest relative error", "max_rel_bond_error"}, false);
  p.script += panel_of(c, {"total energy", "|E − E_0| [kJ/mol]", "energy_kj_mol", true, true}, false);
  p.script += "  unset multiplot\n";
  return p;
}

// OpenMM's other runs are too short for averages.
bool averaged(const Crosscheck& c, const Track* track) {
  return track != &c.verlet && track != &c.nudged && !track->oxygens.r.empty();
}

std::string distances_csv(const Crosscheck& c) {
  std::string text = "run,r_nm,g,standard_error\n";
  for (const auto& [track, style] : curves_of(c))
    for (std::size_t n = 0; averaged(c, track) && n < track->oxygens.r.size(); ++n)
      text += fmt::format("{},{:.4f},{:.6f},{:.6f}\n", csv_cell(track->name), track->oxygens.r[n],
                          track->oxygens.g[n].value, track->oxygens.g[n].error);
  return text;
}

Picture distances_picture(const Crosscheck& c) {
  Picture p{"distances", distances_csv(c), "", 800, 520};
  p.script = fmt::format(
      "  set title {} noenhanced\n  set xlabel 'r [nm]'\n"
      "  set ylabel 'g(r)'\n  set key noenhanced\n  plot ",
      gnuplot_string(c.scene + ": O–O radial distribution, bars: standard errors"));
  const char* separator = "";
  for (const auto& [track, style] : curves_of(c)) {
    if (!averaged(c, track)) continue;
    p.script += fmt::format(
        "{0}csv using (strcol('run') eq {1} ? column('r_nm') : 1/0):'g':'standard_error' with yerrorlines "
        "{2} "
        "title {1}",
        separator, gnuplot_string(track->name), style);
    separator = ", \\\n       ";
  }
  p.script += "\n";
  return p;
}

}  // namespace

void draw_crosscheck(const Crosscheck& c, const std::string& csv, StudyFiles& files) {
  files.draw(runs_picture(c, csv));
  if (!c.twin.oxygens.r.empty()) files.draw(distances_picture(c));
}

}  // namespace taut
