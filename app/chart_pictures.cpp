#include "chart_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "studies/csv.hpp"

namespace taut {
namespace {

using Rows = std::vector<std::vector<std::string>>;

// Whether a row that begins with these cells got through: its last one, the reason, is empty.
bool any_row(const Rows& rows, const std::vector<std::string>& cells) {
  return std::ranges::any_of(rows, [&](const auto& row) {
    return row.back().empty() && std::equal(cells.begin(), cells.end(), row.begin());
  });
}

// Curves in their order, each named once, with those left out of which every point failed.
std::vector<Setting> curves_of(const ChartPlan& plan, const std::string& csv) {
  const Rows rows = csv_rows(csv);
  std::vector<Setting> curves;
  for (const Setting& s : plan.settings()) {
    const bool known = std::ranges::any_of(curves, [&](const Setting& c) { return c.curve() == s.curve(); });
    if (!known && any_row(rows, {s.curve()})) curves.push_back(s);
  }
  return curves;
}

// A method's further curves are dashed.
std::string line_of(const std::vector<Setting>& curves, std::size_t n) {
  int earlier = 0;
  for (std::size_t k = 0; k < n; ++k) earlier += curves[k].method == curves[n].method;
  return mark_of(curves[n].method) + fmt::format(" dt {} lw 1.5 ps 0.9", earlier == 0 ? 1 : 2 + earlier);
}

std::string only(const std::string& key, const std::string& name, const std::string& what) {
  return fmt::format("(strcol('{}') eq '{}' ? {} : 1/0)", key, name, what);
}

constexpr const char* kLogLog = "  set logscale xy\n  set format x '10^{%L}'\n  set format y '%g'\n";

std::string joined(const std::vector<std::string>& plots) {
  std::string text = "  plot ";
  for (std::size_t n = 0; n < plots.size(); ++n) text += (n ? ", \\\n       " : "") + plots[n];
  return text + "\n";
}

// Rounding leaves 1e-16 at the least: a 0 is drawn there.
std::string error_column(const char* name) {
  return fmt::format("(column('{0}') > 1e-16 ? column('{0}') : 1e-16)", name);
}

Picture work_picture(const ChartPlan& plan, const Ledger& ledger) {
  Picture p{"work", work_csv(plan, ledger), "", 800, 600};
  const auto curves = curves_of(plan, p.csv);
  const auto half = [&](const char* column, bool with_key) {
    std::vector<std::string> plots;
    for (std::size_t n = 0; n < curves.size(); ++n) {
      const std::string c = curves[n].curve();
      plots.push_back(
          fmt::format("csv using {}:'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' "
                      "with yerrorlines {} title '{}'",
                      only("curve", c, error_column(column)), line_of(curves, n), with_key ? c : ""));
    }
    return joined(plots);
  };
  if (curves.empty()) return p;
  p.script = fmt::format(
      "{}  set multiplot title {} noenhanced\n"
      "  set xrange [5e-17:1e-1]\n  set xtics 1e-16,1e3\n"
      "  set bmargin screen 0.26\n  set tmargin screen 0.92\n"
      "  set lmargin screen 0.09\n  set rmargin screen 0.52\n"
      "  set ylabel 'constraint time a bond and step [ns]'\n  set xlabel 'rms relative bond error'\n"
      "  set key noenhanced at screen 0.5,0.005 center bottom maxrows 5 samplen 3 width -1\n{}"
      "  set lmargin screen 0.56\n  set rmargin screen 0.98\n  unset key\n  unset ylabel\n  set format y ''\n"
      "  set xlabel 'largest relative bond error'\n{}  unset multiplot\n",
      kLogLog,
      gnuplot_string(fmt::format("{}: constraints at {:g} fs (lower left is better)", plan.scene.name,
                                 plan.scene.run.dt_fs)),
      half("rms_rel_bond_error", true), half("max_rel_bond_error", false));
  return p;
}

// A decade below the smallest drift.
double left_edge(const ChartPlan& plan, const Ledger& ledger) {
  double least = 1;
  for (const Setting& s : plan.settings())
    if (const double drift = std::abs(ledger.at("drift/" + s.name()).drift); drift > 0)
      least = std::min(least, drift);
  return std::pow(10, std::floor(std::log10(least)) - 1);
}

// |drift| with the part of its interval on its own side of zero; an interval that holds zero runs to the
// edge.
Picture drift_picture(const ChartPlan& plan, const Ledger& ledger) {
  Picture p{"drift", drift_csv(plan, ledger), "", 800, 560};
  const auto curves = curves_of(plan, p.csv);
  std::vector<std::string> plots;
  for (std::size_t n = 0; n < curves.size(); ++n)
    plots.push_back(
        fmt::format("csv using {}:'ns_per_bond_step':(low(column('drift_low'), column('drift_high'))):"
                    "(high(column('drift_low'), column('drift_high'))) with xerrorlines {} title '{}'",
                    only("curve", curves[n].curve(), "abs(column('drift_kj_mol_ns_dof'))"),
                    line_of(curves, n), curves[n].curve()));
  if (plots.empty()) return p;
  p.script = fmt::format(
      "{}  low(a, b) = a*b > 0 ? (abs(a) < abs(b) ? abs(a) : abs(b)) : 1e-12\n"
      "  high(a, b) = abs(a) > abs(b) ? abs(a) : abs(b)\n"
      "  set title {} noenhanced\n"
      "  set xlabel '|energy drift| [kJ/mol/ns/degree of freedom], 95 % interval; to the left edge: zero is "
      "inside'\n"
      "  set ylabel 'constraint time a bond and step [ns]'\n  set xrange [{:g}:*]\n"
      "  set bmargin screen 0.29\n  set key noenhanced at screen 0.5,0.005 center bottom maxrows 5 samplen 3 "
      "width -1\n{}",
      kLogLog,
      gnuplot_string(fmt::format("{}: energy drift at {:g} fs over {} steps (lower left is better)",
                                 plan.scene.name, plan.scene.run.dt_fs, plan.drift_steps)),
      left_edge(plan, ledger), joined(plots));
  return p;
}

Picture order_picture(const ChartPlan& plan, const Ledger& ledger) {
  Picture p{"order", order_csv(plan, ledger), "", 800, 520};
  const Rows rows = csv_rows(p.csv);
  std::vector<std::string> plots;
  for (const auto& method : plan.methods)
    if (any_row(rows, {method}))
      plots.push_back(
          fmt::format("csv using {}:'rms_distance_nm' with linespoints {} lw 1.5 title '{} (order {:.2f})'",
                      only("method", method, "column('dt_fs')"), mark_of(method), method,
                      order_of(plan, ledger, method)));
  if (plots.empty()) return p;
  p.script = fmt::format(
      "  set logscale xy\n  set format y '10^{{%L}}'\n"
      "  set title {} noenhanced\n"
      "  set xlabel 'step [fs]'\n  set ylabel 'rms distance [nm]'\n  set key noenhanced outside right "
      "samplen 2\n"
      "  set xrange [{:g}:{:g}]\n{}",
      gnuplot_string(fmt::format("{}: distance from the exact trajectory after {:g} fs", plan.scene.name,
                                 16 * plan.scene.run.dt_fs)),
      plan.scene.run.dt_fs / (plan.quick ? 5 : 20), 1.25 * plan.scene.run.dt_fs, joined(plots));
  return p;
}

Picture length_picture(const ChartPlan& plan, const Ledger& ledger) {
  Picture p{"length", length_csv(plan, ledger), "", 800, 520};
  const Rows rows = csv_rows(p.csv);
  std::vector<std::string> plots;
  for (const auto& method : plan.methods)
    if (any_row(rows, {method}))
      plots.push_back(
          fmt::format("csv using {}:'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with "
                      "yerrorlines {} lw 1.5 "
                      "title '{}'",
                      only("method", method, "column('bonds')"), mark_of(method), method));
  if (plots.empty()) return p;
  p.script = fmt::format(
      "{}  set title 'cost against the length of freely jointed chains'\n  set format x '%g'\n"
      "  set xlabel 'bonds a chain'\n  set ylabel 'constraint time a bond and step [ns]'\n"
      "  set key noenhanced outside right samplen 2\n{}",
      kLogLog, joined(plots));
  return p;
}

// Filled: double; open: mixed.
Picture precision_picture(const ChartPlan& plan, const Ledger& ledger) {
  Picture p{"precision", precision_csv(plan, ledger), "", 800, 520};
  const Rows rows = csv_rows(p.csv);
  std::vector<std::string> plots;
  for (const auto& method : plan.methods)
    for (const char* precision : {"double", "mixed"})
      if (any_row(rows, {method, precision}))
        plots.push_back(fmt::format(
            "csv using (strcol('method') eq '{0}' && strcol('precision') eq '{1}' ? "
            "abs(column('drift_kj_mol_ns_dof')) : 1/0):'step_us':"
            "(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), "
            "column('drift_high'))):"
            "'step_us_q1':'step_us_q3' with xyerrorbars {2} {3} lw 1.5 title '{0}, {1}'",
            method, precision, mark_of(method), precision == std::string("double") ? "dt 1" : "dt 3 ps 0.6"));
  if (plots.empty()) return p;
  p.script = fmt::format(
      "  set logscale x\n  set format x '10^{{%L}}'\n"
      "  low(a, b) = a*b > 0 ? (abs(a) < abs(b) ? abs(a) : abs(b)) : 1e-12\n"
      "  high(a, b) = abs(a) > abs(b) ? abs(a) : abs(b)\n"
      "  set title {} noenhanced\n"
      "  set xlabel '|energy drift| [kJ/mol/ns/degree of freedom], 95 % interval; to the left edge: zero is "
      "inside'\n"
      "  set ylabel 'time of a step [µs]'\n  set yrange [0:*]\n  set xrange [1e-4:*]\n  set key noenhanced "
      "outside "
      "right samplen 2\n{}",
      gnuplot_string(fmt::format(
          "{}: a whole step at {:g} fs, pair forces in double (full bars) and mixed precision (dotted)",
          plan.scene.name, plan.scene.run.dt_fs)),
      joined(plots));
  return p;
}

}  // namespace

std::vector<CaptionedPicture> chart_pictures(const ChartPlan& plan, const Ledger& ledger) {
  std::vector<CaptionedPicture> all = {
      {work_picture(plan, ledger), "Constraint time against bond error",
       fmt::format("A curve a method; its points are the values of the named setting. Bars: quartiles of {} "
                   "interleaved repeats of {} steps.",
                   plan.repeats, plan.steps)},
      {drift_picture(plan, ledger), "Constraint time against energy drift",
       fmt::format(
           "Slope of the total energy over {} steps; bars: 95 % of 400 block bootstraps. A bar to the left "
           "edge: zero is inside.",
           plan.drift_steps)},
      {order_picture(plan, ledger), "Trajectory error against step",
       "Distance from a run of newton at 1e-12 and a step of a quarter of the finest shown. The order is the "
       "slope; iterative methods are held to 1e-11."},
      {length_picture(plan, ledger), "Cost against chain length",
       "Freely jointed chains at 10 fs; iterative methods at tolerance 1e-8, the others at their defaults. "
       "No "
       "other scene's forces are in it."}};
  if (has_precisions(plan.scene))
    all.push_back(
        {precision_picture(plan, ledger), "What mixed precision costs and gains",
         "A whole step, every method at its defaults; pair geometry and force in single precision, sums in "
         "double."});
  return all;
}

}  // namespace taut
