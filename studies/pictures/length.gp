# Draws length.svg and length.png from length.csv: `gnuplot length.gp` in this folder.
name = 'length'
load 'taut.gp'
stats csv using (is_number(column('ns_per_bond_step')) ? add_curve(strcol('method'), strcol('method')) : 0) nooutput
eval expect_curves

do for [kind in 'svg png'] {
  eval page(kind, 800, 520)
  set title title noenhanced
  set logscale xy
  set format '%g'
  set xlabel 'bonds a chain'
  set ylabel cost_label
  set key noenhanced outside right samplen 2
  plot for [k=1:curves] csv using (strcol('method') eq curve[k] ? column('bonds') : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb colour(k) pt mark(k) lw 1.5 title curve[k]
}
