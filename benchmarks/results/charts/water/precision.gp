# Draws precision.svg and precision.png from precision.csv: `gnuplot precision.gp` in this folder.
csv = 'precision.csv'
set encoding utf8
do for [kind in 'svg png'] {
  reset
  set datafile separator ','
  set datafile columnheaders
  if (kind eq 'svg') {
    set terminal svg size 800,520 background 'white' font 'Helvetica,12'
  } else {
    set terminal pngcairo size 800,520 background 'white' font 'Helvetica,11'
  }
  set output 'precision.'.kind
  set grid lc rgb '#dddddd' lt 1
  set border lw 0.8
  set tics nomirror
  set logscale x
  set format x '10^{%L}'
  low(a, b) = a*b > 0 ? (abs(a) < abs(b) ? abs(a) : abs(b)) : 1e-12
  high(a, b) = abs(a) > abs(b) ? abs(a) : abs(b)
  set title 'water: a whole step at 2 fs, pair forces in double (full bars) and mixed precision (dotted)' noenhanced
  set xlabel '|energy drift| [kJ/mol/ns/degree of freedom], 95 % interval; to the left edge: zero is inside'
  set ylabel 'time of a step [µs]'
  set yrange [0:*]
  set xrange [1e-4:*]
  set key noenhanced outside right samplen 2
  plot csv using (strcol('method') eq 'baumgarte' && strcol('precision') eq 'double' ? abs(column('drift_kj_mol_ns_dof')) : 1/0):'step_us':(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), column('drift_high'))):'step_us_q1':'step_us_q3' with xyerrorbars lc rgb '#D55E00' pt 7 dt 1 lw 1.5 title 'baumgarte, double', \
       csv using (strcol('method') eq 'baumgarte' && strcol('precision') eq 'mixed' ? abs(column('drift_kj_mol_ns_dof')) : 1/0):'step_us':(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), column('drift_high'))):'step_us_q1':'step_us_q3' with xyerrorbars lc rgb '#D55E00' pt 7 dt 3 ps 0.6 lw 1.5 title 'baumgarte, mixed', \
       csv using (strcol('method') eq 'feedforward' && strcol('precision') eq 'double' ? abs(column('drift_kj_mol_ns_dof')) : 1/0):'step_us':(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), column('drift_high'))):'step_us_q1':'step_us_q3' with xyerrorbars lc rgb '#000000' pt 5 dt 1 lw 1.5 title 'feedforward, double', \
       csv using (strcol('method') eq 'feedforward' && strcol('precision') eq 'mixed' ? abs(column('drift_kj_mol_ns_dof')) : 1/0):'step_us':(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), column('drift_high'))):'step_us_q1':'step_us_q3' with xyerrorbars lc rgb '#000000' pt 5 dt 3 ps 0.6 lw 1.5 title 'feedforward, mixed', \
       csv using (strcol('method') eq 'shake' && strcol('precision') eq 'double' ? abs(column('drift_kj_mol_ns_dof')) : 1/0):'step_us':(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), column('drift_high'))):'step_us_q1':'step_us_q3' with xyerrorbars lc rgb '#56B4E9' pt 8 dt 1 lw 1.5 title 'shake, double', \
       csv using (strcol('method') eq 'shake' && strcol('precision') eq 'mixed' ? abs(column('drift_kj_mol_ns_dof')) : 1/0):'step_us':(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), column('drift_high'))):'step_us_q1':'step_us_q3' with xyerrorbars lc rgb '#56B4E9' pt 8 dt 3 ps 0.6 lw 1.5 title 'shake, mixed', \
       csv using (strcol('method') eq 'rattle' && strcol('precision') eq 'double' ? abs(column('drift_kj_mol_ns_dof')) : 1/0):'step_us':(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), column('drift_high'))):'step_us_q1':'step_us_q3' with xyerrorbars lc rgb '#0072B2' pt 9 dt 1 lw 1.5 title 'rattle, double', \
       csv using (strcol('method') eq 'rattle' && strcol('precision') eq 'mixed' ? abs(column('drift_kj_mol_ns_dof')) : 1/0):'step_us':(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), column('drift_high'))):'step_us_q1':'step_us_q3' with xyerrorbars lc rgb '#0072B2' pt 9 dt 3 ps 0.6 lw 1.5 title 'rattle, mixed', \
       csv using (strcol('method') eq 'newton' && strcol('precision') eq 'double' ? abs(column('drift_kj_mol_ns_dof')) : 1/0):'step_us':(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), column('drift_high'))):'step_us_q1':'step_us_q3' with xyerrorbars lc rgb '#009E73' pt 13 dt 1 lw 1.5 title 'newton, double', \
       csv using (strcol('method') eq 'newton' && strcol('precision') eq 'mixed' ? abs(column('drift_kj_mol_ns_dof')) : 1/0):'step_us':(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), column('drift_high'))):'step_us_q1':'step_us_q3' with xyerrorbars lc rgb '#009E73' pt 13 dt 3 ps 0.6 lw 1.5 title 'newton, mixed', \
       csv using (strcol('method') eq 'lincs' && strcol('precision') eq 'double' ? abs(column('drift_kj_mol_ns_dof')) : 1/0):'step_us':(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), column('drift_high'))):'step_us_q1':'step_us_q3' with xyerrorbars lc rgb '#CC79A7' pt 12 dt 1 lw 1.5 title 'lincs, double', \
       csv using (strcol('method') eq 'lincs' && strcol('precision') eq 'mixed' ? abs(column('drift_kj_mol_ns_dof')) : 1/0):'step_us':(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), column('drift_high'))):'step_us_q1':'step_us_q3' with xyerrorbars lc rgb '#CC79A7' pt 12 dt 3 ps 0.6 lw 1.5 title 'lincs, mixed', \
       csv using (strcol('method') eq 'settle' && strcol('precision') eq 'double' ? abs(column('drift_kj_mol_ns_dof')) : 1/0):'step_us':(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), column('drift_high'))):'step_us_q1':'step_us_q3' with xyerrorbars lc rgb '#E69F00' pt 11 dt 1 lw 1.5 title 'settle, double', \
       csv using (strcol('method') eq 'settle' && strcol('precision') eq 'mixed' ? abs(column('drift_kj_mol_ns_dof')) : 1/0):'step_us':(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), column('drift_high'))):'step_us_q1':'step_us_q3' with xyerrorbars lc rgb '#E69F00' pt 11 dt 3 ps 0.6 lw 1.5 title 'settle, mixed'
}
