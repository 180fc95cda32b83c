# Draws drift.svg and drift.png from drift.csv: `gnuplot drift.gp` in this folder.
name = 'drift'
load 'taut.gp'
least = 1
seen(d) = d > 0 && d < least ? (least = d) : d
stats csv using (is_number(column('ns_per_bond_step')) ? (seen(drift_at(column('drift_kj_mol_ns_dof'), column('drift_low'), column('drift_high'))), add_curve(strcol('curve'), strcol('method'))) : 0) nooutput
eval expect_curves

do for [kind in 'svg png'] {
  eval page(kind, 800, 560)
  set title title noenhanced
  set logscale xy
  set format x '10^{%L}'
  set format y '%g'
  set xrange [10**floor(log10(least / 2.0)):*]
  set xlabel drift_label
  set ylabel cost_label
  set bmargin screen 0.31
  set key noenhanced at screen 0.5,0.005 center bottom maxrows 5 samplen 3 width -1
  plot for [k=1:curves] csv using (only_if(strcol('curve') eq curve[k], @at_drift)):'ns_per_bond_step' with linespoints lc rgb colour(k) pt mark(k) dt dash(k) lw 1.5 ps 0.9 title curve[k], \
       for [k=1:curves] csv using (only_if(strcol('curve') eq curve[k] && !has_zero(column('drift_low'), column('drift_high')), @at_drift)):'ns_per_bond_step':(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), column('drift_high'))) with xerrorbars lc rgb colour(k) pt mark(k) ps 0.9 lw 1 notitle, \
       for [k=1:curves] csv using (only_if(strcol('curve') eq curve[k] && has_zero(column('drift_low'), column('drift_high')), @at_drift)):'ns_per_bond_step':(-arrow_share * @at_drift):(0) with vectors head size screen 0.007,20 filled lc rgb colour(k) lw 1 notitle
}
