# Draws relaxation.svg and relaxation.png from relaxation.csv: `gnuplot relaxation.gp` in this folder.
name = 'relaxation'
load 'taut.gp'
stats csv using (add_curve(strcol('run'), 'run'), 0) nooutput
eval expect_curves

do for [kind in 'svg png'] {
  eval page(kind, 800, 520)
  set title title noenhanced
  set xlabel 't [ps]'
  set ylabel '⟨R(0)·R(t)⟩/⟨R²⟩'
  set key noenhanced right top
  plot for [k=1:curves] csv using (strcol('run') eq curve[k] ? column('t_ps') : 1/0):'correlation':'standard_error' with yerrorlines lc rgb hue(k) pt 7 lw 1.5 ps 0.5 title curve[k], exp(-1) with lines lc rgb '#777777' dt 2 title '1/e'
}
