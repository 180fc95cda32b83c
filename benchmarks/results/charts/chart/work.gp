# Draws work.svg and work.png from work.csv: `gnuplot work.gp` in this folder.
csv = 'work.csv'
set encoding utf8
do for [kind in 'svg png'] {
  reset
  set datafile separator ','
  set datafile columnheaders
  if (kind eq 'svg') {
    set terminal svg size 800,600 background 'white' font 'Helvetica,12'
  } else {
    set terminal pngcairo size 800,600 background 'white' font 'Helvetica,11'
  }
  set output 'work.'.kind
  set grid lc rgb '#dddddd' lt 1
  set border lw 0.8
  set tics nomirror
  set logscale xy
  set format x '10^{%L}'
  set format y '%g'
  set multiplot title 'freely_jointed: constraints at 10 fs (lower left is better)' noenhanced
  set xrange [5e-17:1e-1]
  set xtics 1e-16,1e3
  set bmargin screen 0.26
  set tmargin screen 0.92
  set lmargin screen 0.09
  set rmargin screen 0.52
  set ylabel 'constraint time a bond and step [ns]'
  set xlabel 'rms relative bond error'
  set key noenhanced at screen 0.5,0.005 center bottom maxrows 5 samplen 3 width -1
  plot csv using (strcol('curve') eq 'none' ? (column('rms_rel_bond_error') > 1e-16 ? column('rms_rel_bond_error') : 1e-16) : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#999999' pt 6 dt 1 lw 1.5 ps 0.9 title 'none', \
       csv using (strcol('curve') eq 'penalty (omega_h)' ? (column('rms_rel_bond_error') > 1e-16 ? column('rms_rel_bond_error') : 1e-16) : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#8C564B' pt 4 dt 1 lw 1.5 ps 0.9 title 'penalty (omega_h)', \
       csv using (strcol('curve') eq 'baumgarte (sweeps)' ? (column('rms_rel_bond_error') > 1e-16 ? column('rms_rel_bond_error') : 1e-16) : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#D55E00' pt 7 dt 1 lw 1.5 ps 0.9 title 'baumgarte (sweeps)', \
       csv using (strcol('curve') eq 'baumgarte (gains)' ? (column('rms_rel_bond_error') > 1e-16 ? column('rms_rel_bond_error') : 1e-16) : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#D55E00' pt 7 dt 3 lw 1.5 ps 0.9 title 'baumgarte (gains)', \
       csv using (strcol('curve') eq 'feedforward (tolerance)' ? (column('rms_rel_bond_error') > 1e-16 ? column('rms_rel_bond_error') : 1e-16) : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#000000' pt 5 dt 1 lw 1.5 ps 0.9 title 'feedforward (tolerance)', \
       csv using (strcol('curve') eq 'feedforward (extrapolation)' ? (column('rms_rel_bond_error') > 1e-16 ? column('rms_rel_bond_error') : 1e-16) : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#000000' pt 5 dt 3 lw 1.5 ps 0.9 title 'feedforward (extrapolation)', \
       csv using (strcol('curve') eq 'shake (tolerance)' ? (column('rms_rel_bond_error') > 1e-16 ? column('rms_rel_bond_error') : 1e-16) : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#56B4E9' pt 8 dt 1 lw 1.5 ps 0.9 title 'shake (tolerance)', \
       csv using (strcol('curve') eq 'shake (sweeps)' ? (column('rms_rel_bond_error') > 1e-16 ? column('rms_rel_bond_error') : 1e-16) : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#56B4E9' pt 8 dt 3 lw 1.5 ps 0.9 title 'shake (sweeps)', \
       csv using (strcol('curve') eq 'rattle (tolerance)' ? (column('rms_rel_bond_error') > 1e-16 ? column('rms_rel_bond_error') : 1e-16) : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#0072B2' pt 9 dt 1 lw 1.5 ps 0.9 title 'rattle (tolerance)', \
       csv using (strcol('curve') eq 'rattle (sweeps)' ? (column('rms_rel_bond_error') > 1e-16 ? column('rms_rel_bond_error') : 1e-16) : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#0072B2' pt 9 dt 3 lw 1.5 ps 0.9 title 'rattle (sweeps)', \
       csv using (strcol('curve') eq 'newton (tolerance)' ? (column('rms_rel_bond_error') > 1e-16 ? column('rms_rel_bond_error') : 1e-16) : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#009E73' pt 13 dt 1 lw 1.5 ps 0.9 title 'newton (tolerance)', \
       csv using (strcol('curve') eq 'lincs (order)' ? (column('rms_rel_bond_error') > 1e-16 ? column('rms_rel_bond_error') : 1e-16) : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#CC79A7' pt 12 dt 1 lw 1.5 ps 0.9 title 'lincs (order)', \
       csv using (strcol('curve') eq 'lincs (iterations)' ? (column('rms_rel_bond_error') > 1e-16 ? column('rms_rel_bond_error') : 1e-16) : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#CC79A7' pt 12 dt 3 lw 1.5 ps 0.9 title 'lincs (iterations)'
  set lmargin screen 0.56
  set rmargin screen 0.98
  unset key
  unset ylabel
  set format y ''
  set xlabel 'largest relative bond error'
  plot csv using (strcol('curve') eq 'none' ? (column('max_rel_bond_error') > 1e-16 ? column('max_rel_bond_error') : 1e-16) : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#999999' pt 6 dt 1 lw 1.5 ps 0.9 title '', \
       csv using (strcol('curve') eq 'penalty (omega_h)' ? (column('max_rel_bond_error') > 1e-16 ? column('max_rel_bond_error') : 1e-16) : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#8C564B' pt 4 dt 1 lw 1.5 ps 0.9 title '', \
       csv using (strcol('curve') eq 'baumgarte (sweeps)' ? (column('max_rel_bond_error') > 1e-16 ? column('max_rel_bond_error') : 1e-16) : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#D55E00' pt 7 dt 1 lw 1.5 ps 0.9 title '', \
       csv using (strcol('curve') eq 'baumgarte (gains)' ? (column('max_rel_bond_error') > 1e-16 ? column('max_rel_bond_error') : 1e-16) : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#D55E00' pt 7 dt 3 lw 1.5 ps 0.9 title '', \
       csv using (strcol('curve') eq 'feedforward (tolerance)' ? (column('max_rel_bond_error') > 1e-16 ? column('max_rel_bond_error') : 1e-16) : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#000000' pt 5 dt 1 lw 1.5 ps 0.9 title '', \
       csv using (strcol('curve') eq 'feedforward (extrapolation)' ? (column('max_rel_bond_error') > 1e-16 ? column('max_rel_bond_error') : 1e-16) : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#000000' pt 5 dt 3 lw 1.5 ps 0.9 title '', \
       csv using (strcol('curve') eq 'shake (tolerance)' ? (column('max_rel_bond_error') > 1e-16 ? column('max_rel_bond_error') : 1e-16) : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#56B4E9' pt 8 dt 1 lw 1.5 ps 0.9 title '', \
       csv using (strcol('curve') eq 'shake (sweeps)' ? (column('max_rel_bond_error') > 1e-16 ? column('max_rel_bond_error') : 1e-16) : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#56B4E9' pt 8 dt 3 lw 1.5 ps 0.9 title '', \
       csv using (strcol('curve') eq 'rattle (tolerance)' ? (column('max_rel_bond_error') > 1e-16 ? column('max_rel_bond_error') : 1e-16) : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#0072B2' pt 9 dt 1 lw 1.5 ps 0.9 title '', \
       csv using (strcol('curve') eq 'rattle (sweeps)' ? (column('max_rel_bond_error') > 1e-16 ? column('max_rel_bond_error') : 1e-16) : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#0072B2' pt 9 dt 3 lw 1.5 ps 0.9 title '', \
       csv using (strcol('curve') eq 'newton (tolerance)' ? (column('max_rel_bond_error') > 1e-16 ? column('max_rel_bond_error') : 1e-16) : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#009E73' pt 13 dt 1 lw 1.5 ps 0.9 title '', \
       csv using (strcol('curve') eq 'lincs (order)' ? (column('max_rel_bond_error') > 1e-16 ? column('max_rel_bond_error') : 1e-16) : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#CC79A7' pt 12 dt 1 lw 1.5 ps 0.9 title '', \
       csv using (strcol('curve') eq 'lincs (iterations)' ? (column('max_rel_bond_error') > 1e-16 ? column('max_rel_bond_error') : 1e-16) : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#CC79A7' pt 12 dt 3 lw 1.5 ps 0.9 title ''
  unset multiplot
}
