# Draws drift.svg and drift.png from drift.csv: `gnuplot drift.gp` in this folder.
csv = 'drift.csv'
set encoding utf8
do for [kind in 'svg png'] {
  reset
  set datafile separator ','
  set datafile columnheaders
  if (kind eq 'svg') {
    set terminal svg size 800,560 background 'white' font 'Helvetica,12'
  } else {
    set terminal pngcairo size 800,560 background 'white' font 'Helvetica,11'
  }
  set output 'drift.'.kind
  set grid lc rgb '#dddddd' lt 1
  set border lw 0.8
  set tics nomirror
  set logscale xy
  set format x '10^{%L}'
  set format y '%g'
  low(a, b) = a*b > 0 ? (abs(a) < abs(b) ? abs(a) : abs(b)) : 1e-12
  high(a, b) = abs(a) > abs(b) ? abs(a) : abs(b)
  set title 'freely_jointed: energy drift at 10 fs over 10000 steps (lower left is better)' noenhanced
  set xlabel '|energy drift| [kJ/mol/ns/degree of freedom], 95 % interval; to the left edge: zero is inside'
  set ylabel 'constraint time a bond and step [ns]'
  set xrange [1e-08:*]
  set bmargin screen 0.29
  set key noenhanced at screen 0.5,0.005 center bottom maxrows 5 samplen 3 width -1
  plot csv using (strcol('curve') eq 'penalty (omega_h)' ? abs(column('drift_kj_mol_ns_dof')) : 1/0):'ns_per_bond_step':(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), column('drift_high'))) with xerrorlines lc rgb '#8C564B' pt 4 dt 1 lw 1.5 ps 0.9 title 'penalty (omega_h)', \
       csv using (strcol('curve') eq 'baumgarte (sweeps)' ? abs(column('drift_kj_mol_ns_dof')) : 1/0):'ns_per_bond_step':(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), column('drift_high'))) with xerrorlines lc rgb '#D55E00' pt 7 dt 1 lw 1.5 ps 0.9 title 'baumgarte (sweeps)', \
       csv using (strcol('curve') eq 'baumgarte (gains)' ? abs(column('drift_kj_mol_ns_dof')) : 1/0):'ns_per_bond_step':(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), column('drift_high'))) with xerrorlines lc rgb '#D55E00' pt 7 dt 3 lw 1.5 ps 0.9 title 'baumgarte (gains)', \
       csv using (strcol('curve') eq 'feedforward (tolerance)' ? abs(column('drift_kj_mol_ns_dof')) : 1/0):'ns_per_bond_step':(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), column('drift_high'))) with xerrorlines lc rgb '#000000' pt 5 dt 1 lw 1.5 ps 0.9 title 'feedforward (tolerance)', \
       csv using (strcol('curve') eq 'feedforward (extrapolation)' ? abs(column('drift_kj_mol_ns_dof')) : 1/0):'ns_per_bond_step':(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), column('drift_high'))) with xerrorlines lc rgb '#000000' pt 5 dt 3 lw 1.5 ps 0.9 title 'feedforward (extrapolation)', \
       csv using (strcol('curve') eq 'shake (tolerance)' ? abs(column('drift_kj_mol_ns_dof')) : 1/0):'ns_per_bond_step':(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), column('drift_high'))) with xerrorlines lc rgb '#56B4E9' pt 8 dt 1 lw 1.5 ps 0.9 title 'shake (tolerance)', \
       csv using (strcol('curve') eq 'shake (sweeps)' ? abs(column('drift_kj_mol_ns_dof')) : 1/0):'ns_per_bond_step':(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), column('drift_high'))) with xerrorlines lc rgb '#56B4E9' pt 8 dt 3 lw 1.5 ps 0.9 title 'shake (sweeps)', \
       csv using (strcol('curve') eq 'rattle (tolerance)' ? abs(column('drift_kj_mol_ns_dof')) : 1/0):'ns_per_bond_step':(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), column('drift_high'))) with xerrorlines lc rgb '#0072B2' pt 9 dt 1 lw 1.5 ps 0.9 title 'rattle (tolerance)', \
       csv using (strcol('curve') eq 'rattle (sweeps)' ? abs(column('drift_kj_mol_ns_dof')) : 1/0):'ns_per_bond_step':(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), column('drift_high'))) with xerrorlines lc rgb '#0072B2' pt 9 dt 3 lw 1.5 ps 0.9 title 'rattle (sweeps)', \
       csv using (strcol('curve') eq 'newton (tolerance)' ? abs(column('drift_kj_mol_ns_dof')) : 1/0):'ns_per_bond_step':(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), column('drift_high'))) with xerrorlines lc rgb '#009E73' pt 13 dt 1 lw 1.5 ps 0.9 title 'newton (tolerance)', \
       csv using (strcol('curve') eq 'lincs (order)' ? abs(column('drift_kj_mol_ns_dof')) : 1/0):'ns_per_bond_step':(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), column('drift_high'))) with xerrorlines lc rgb '#CC79A7' pt 12 dt 1 lw 1.5 ps 0.9 title 'lincs (order)', \
       csv using (strcol('curve') eq 'lincs (iterations)' ? abs(column('drift_kj_mol_ns_dof')) : 1/0):'ns_per_bond_step':(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), column('drift_high'))) with xerrorlines lc rgb '#CC79A7' pt 12 dt 3 lw 1.5 ps 0.9 title 'lincs (iterations)'
}
