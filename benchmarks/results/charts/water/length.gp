# Draws length.svg and length.png from length.csv: `gnuplot length.gp` in this folder.
csv = 'length.csv'
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
  set output 'length.'.kind
  set grid lc rgb '#dddddd' lt 1
  set border lw 0.8
  set tics nomirror
  set logscale xy
  set format x '10^{%L}'
  set format y '%g'
  set title 'cost against the length of freely jointed chains'
  set format x '%g'
  set xlabel 'bonds a chain'
  set ylabel 'constraint time a bond and step [ns]'
  set key noenhanced outside right samplen 2
  plot csv using (strcol('method') eq 'none' ? column('bonds') : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#999999' pt 6 lw 1.5 title 'none', \
       csv using (strcol('method') eq 'penalty' ? column('bonds') : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#8C564B' pt 4 lw 1.5 title 'penalty', \
       csv using (strcol('method') eq 'baumgarte' ? column('bonds') : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#D55E00' pt 7 lw 1.5 title 'baumgarte', \
       csv using (strcol('method') eq 'feedforward' ? column('bonds') : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#000000' pt 5 lw 1.5 title 'feedforward', \
       csv using (strcol('method') eq 'shake' ? column('bonds') : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#56B4E9' pt 8 lw 1.5 title 'shake', \
       csv using (strcol('method') eq 'rattle' ? column('bonds') : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#0072B2' pt 9 lw 1.5 title 'rattle', \
       csv using (strcol('method') eq 'newton' ? column('bonds') : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#009E73' pt 13 lw 1.5 title 'newton', \
       csv using (strcol('method') eq 'lincs' ? column('bonds') : 1/0):'ns_per_bond_step':'ns_per_bond_step_q1':'ns_per_bond_step_q3' with yerrorlines lc rgb '#CC79A7' pt 12 lw 1.5 title 'lincs'
}
