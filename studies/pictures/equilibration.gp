# Draws equilibration.svg and equilibration.png from equilibration.csv: `gnuplot equilibration.gp` in this folder.
name = 'equilibration'
load 'taut.gp'

do for [kind in 'svg png'] {
  eval page(kind, 800, 400)
  set title title noenhanced
  set xlabel 't [ps]'
  set ylabel 'potential energy [kJ/mol]'
  set key noenhanced
  plot csv using 't_ps':'left_out_kj_mol' with lines lc rgb '#D55E00' title 'left out', \
       csv using 't_ps':'measured_kj_mol' with lines lc rgb '#0072B2' title 'measured'
}
