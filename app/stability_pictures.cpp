#include "stability_pictures.hpp"

#include <fmt/format.h>

#include <cmath>

namespace taut {
namespace {

// Light is good in all of them, and grey tones keep the order.
constexpr const char* kPlane =
    R"(  set multiplot title {0} noenhanced
  set logscale x
  set xrange [{1:g}:{2:g}]
  set yrange [{3:g}:{4:g}]
  set xtics ('0.01' 0.01, '0.1' 0.1, '1' 1)
  set ytics 0.5
  set style fill solid noborder
  half = {5:g}
  wide = {6:g}
  unset key
  do for [row = 0:1] {{
    do for [n = 1:3] {{
      damping = word('centred implicit lagged', n)
      set lmargin screen 0.08 + 0.265 * (n - 1)
      set rmargin screen 0.08 + 0.265 * (n - 1) + 0.25
      set tmargin screen 0.88 - 0.45 * row
      set bmargin screen 0.54 - 0.45 * row
      if (n == 1) {{ set ylabel 'βh' offset 1; set format y '%g' }} else {{ unset ylabel; set format y '' }}
      if (row == 1) {{ set xlabel 'αh' offset 0,0.6 }} else {{ unset xlabel }}
      if (n == 3) {{ set colorbox user origin 0.88, 0.54 - 0.45 * row size 0.02, 0.34 }} else {{ unset colorbox }}
      set title damping.' damping' offset 0,-0.7
      if (row == 0) {{
        set palette defined (0 '#222255', 0.5 '#7788bb', 1 '#ffffcc')
        set logscale cb
        set format cb '%g'
        set cbrange [1:{7}]
        set cblabel 'steps survived' offset 1
        plot csv using (strcol('damping') eq damping ? column('alpha_h') : 1/0):'beta_h':(column('alpha_h')/wide):(column('alpha_h')*wide):(column('beta_h')-half):(column('beta_h')+half):(column('steps_survived') > 1 ? column('steps_survived') : 1) with boxxyerror palette, \
             'limits.csv' using (strcol('damping') eq damping ? column('alpha_h') : 1/0):'limit_beta_h' with lines lc rgb 'black' lw 3 dt 2
      }} else {{
        set palette defined (0 '#ffffcc', 0.5 '#dd7733', 1 '#441122')
        set logscale cb
        set format cb '10^{{%L}}'
        set autoscale cb
        set cbrange [{8:g}:{9:g}]
        set cblabel '|drift| [kJ/mol/ns/dof]' offset 1
        plot csv using (strcol('damping') eq damping && column('failed') == 0 ? column('alpha_h') : 1/0):'beta_h':(column('alpha_h')/wide):(column('alpha_h')*wide):(column('beta_h')-half):(column('beta_h')+half):(abs(column('drift_kj_mol_ns_dof'))) with boxxyerror palette, \
             csv using (strcol('damping') eq damping && column('failed') == 1 ? column('alpha_h') : 1/0):'beta_h' with points pt 2 ps 0.8 lc rgb '#555555', \
             'limits.csv' using (strcol('damping') eq damping ? column('alpha_h') : 1/0):'limit_beta_h' with lines lc rgb 'black' lw 3 dt 2
      }}
    }}
  }}
  unset multiplot
)";

constexpr const char* kSteps =
    R"(  set title 'Largest stable step [fs], and how the next one fails' noenhanced
  set xrange [-0.5:{0}]
  set yrange [{1}:-0.5] noextend
  unset grid
  unset key
  unset colorbox
  set palette defined (0 '#aaaaaa', 1 '#ffffff')
  set cbrange [-3:0]
  set style fill solid border lc rgb '#888888'
  set xtics scale 0 ({2}) noenhanced
  set ytics scale 0 ({3}) noenhanced
  wrapped(s) = words(s) < 2 ? s : words(s) == 2 ? word(s, 1)."\n".word(s, 2) : words(s) == 3 ? word(s, 1).' '.word(s, 2)."\n".word(s, 3) : word(s, 1).' '.word(s, 2)."\n".word(s, 3).' '.word(s, 4)
  long_as(x) = x > 0 ? sprintf('%.3g', x) : '–'
  plot csv using 'column':'row':(column('column')-0.5):(column('column')+0.5):(column('row')-0.5):(column('row')+0.5):(log10(column('share_of_best') + 1e-3)) with boxxyerror palette, \
       csv using (column('column')):(column('row')-0.25):(long_as(column('largest_stable_fs'))) with labels font ',11' noenhanced, \
       csv using (column('column')):(column('row')+0.17):(wrapped(strcol('fails_as'))) with labels font ',{4}' noenhanced
)";

}  // namespace

Picture plane_picture(const StabilityPlan& plan, const Ledger& ledger) {
  const std::vector<double> ah = plan.ah(), bh = plan.bh();
  const double wide = plan.quick ? std::sqrt(2.0) : std::pow(10, 0.125), half = (bh[1] - bh[0]) / 2;
  double least = 1e9, most = 0;
  for (const auto& name : ledger.names("plane/"))
    if (const Trial& t = ledger.at(name); !t.failed() && t.drift != 0) {
      least = std::min(least, std::abs(t.drift));
      most = std::max(most, std::abs(t.drift));
    }
  const auto decade = [](double value, auto round) { return std::pow(10, round(std::log10(value))); };
  const Scene& scene = plan.scenes.front();
  return {.name = "plane",
          .csv = plane_csv(plan, ledger),
          .script = fmt::format(
              kPlane,
              gnuplot_string(fmt::format("{}: Baumgarte at {:g} fs over the plane of its gains", scene.name,
                                         scene.run.dt_fs)),
              ah.front() / wide, ah.back() * wide, bh.front() - half, bh.back() + half, half, wide,
              plan.plane_steps, most > 0 ? decade(least, [](double x) { return std::floor(x); }) : 0.1,
              most > 0 ? decade(most, [](double x) { return std::ceil(x); }) : 1.0),
          .height = 600};
}

Picture steps_picture(const StabilityPlan& plan, const Ledger& ledger) {
  std::string methods, scenes;
  for (std::size_t n = 0; n < plan.methods.size(); ++n)
    methods += fmt::format("{}{} {}", n ? ", " : "", gnuplot_tic(plan.methods[n]), n);
  for (std::size_t n = 0; n < plan.scenes.size(); ++n)
    scenes += fmt::format("{}{} {}", n ? ", " : "", gnuplot_tic(plan.scenes[n].name), n);
  return {.name = "steps",
          .csv = steps_csv(plan, ledger),
          .script = fmt::format(kSteps, static_cast<double>(plan.methods.size()) - 0.5,
                                static_cast<double>(plan.scenes.size()) - 0.5, methods, scenes, 7),
          .width = 900,
          .height = 120 + 62 * static_cast<int>(plan.scenes.size())};
}

}  // namespace taut
