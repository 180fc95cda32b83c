# Draws work.svg and work.png from work.csv: `gnuplot work.gp` in this folder.
name = 'work'
load 'taut.gp'
stats csv using (is_number(column('ns_per_bond_step')) ? add_curve(strcol('curve'), strcol('method')) : 0) nooutput
eval expect_curves

# Rounding leaves 1e-16 at the least: a 0 is drawn there.
seen(error) = error > 1e-16 ? error : 1e-16

do for [kind in 'svg png'] {
  eval page(kind, 800, 600)
  set multiplot title title noenhanced
  set logscale xy
  set format x '10^{%L}'
  set format y '%g'
  set xrange [5e-17:1e-1]
  set xtics 1e-16,1e3
  set tmargin screen 0.92
  set bmargin screen 0.28
  set key noenhanced at screen 0.5,0.005 center bottom maxrows 5 samplen 3 width -1
  set lmargin screen 0.09
  set rmargin screen 0.52
  set ylabel cost_label
  set xlabel 'rms relative bond error'
  plot for [k=1:curves] csv using (strcol('curve') eq curve[k] ? seen(column('rms_rel_bond_error')) : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb colour(k) pt mark(k) dt dash(k) lw 1.5 ps 0.9 title curve[k]
  set lmargin screen 0.56
  set rmargin screen 0.98
  unset ylabel
  unset key
  set format y ''
  set xlabel 'largest relative bond error'
  plot for [k=1:curves] csv using (strcol('curve') eq curve[k] ? seen(column('max_rel_bond_error')) : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb colour(k) pt mark(k) dt dash(k) lw 1.5 ps 0.9
  unset multiplot
}
