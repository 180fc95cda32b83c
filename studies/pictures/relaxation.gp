# Draws relaxation.svg and relaxation.png from relaxation.csv: `gnuplot relaxation.gp` in this folder.
name = 'relaxation'
load 'taut.gp'

do for [kind in 'svg png'] {
  eval page(kind, 800, 520)
  set title title noenhanced
  set xlabel 't [ps]'
  set ylabel '⟨R(0)·R(t)⟩/⟨R²⟩'
  set key noenhanced
  plot csv using 't_ps':'correlation':'standard_error' with yerrorlines lc rgb '#0072B2' pt 7 lw 1.5 ps 0.5 notitle, exp(-1) with lines lc rgb '#777777' dt 2 title '1/e'
}
