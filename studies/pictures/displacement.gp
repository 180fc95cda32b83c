# Draws displacement.svg and displacement.png from displacement.csv: `gnuplot displacement.gp` in this folder.
name = 'displacement'
load 'taut.gp'

do for [kind in 'svg png'] {
  eval page(kind, 800, 520)
  set title title noenhanced
  set xlabel 't [ps]'
  set ylabel '⟨Δr²⟩ [nm²]'
  unset key
  plot csv using 't_ps':'squared_nm2':'standard_error' with yerrorlines lc rgb '#0072B2' pt 7 lw 1.5 ps 0.7
}
