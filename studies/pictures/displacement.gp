# Draws displacement.svg and displacement.png from displacement.csv: `gnuplot displacement.gp` in this folder.
name = 'displacement'
load 'taut.gp'
stats csv using (add_curve(strcol('run'), 'run'), 0) nooutput
eval expect_curves

do for [kind in 'svg png'] {
  eval page(kind, 800, 520)
  set title title noenhanced
  set xlabel 't [ps]'
  set ylabel '⟨Δr²⟩ [nm²]'
  set key noenhanced left top
  plot for [k=1:curves] csv using (strcol('run') eq curve[k] ? column('t_ps') : 1/0):'squared_nm2':'standard_error' with yerrorlines lc rgb hue(k) pt 7 lw 1.5 ps 0.7 title curve[k]
}
