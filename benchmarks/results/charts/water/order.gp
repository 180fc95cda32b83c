# Draws order.svg and order.png from order.csv: `gnuplot order.gp` in this folder.
csv = 'order.csv'
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
  set output 'order.'.kind
  set grid lc rgb '#dddddd' lt 1
  set border lw 0.8
  set tics nomirror
  set logscale xy
  set format y '10^{%L}'
  set title 'water: distance from the exact trajectory after 32 fs' noenhanced
  set xlabel 'step [fs]'
  set ylabel 'rms distance [nm]'
  set key noenhanced outside right samplen 2
  set xrange [0.1:2.5]
  plot csv using (strcol('method') eq 'none' ? column('dt_fs') : 1/0):'rms_distance_nm' with linespoints lc rgb '#999999' pt 6 lw 1.5 title 'none (order 1.95)', \
       csv using (strcol('method') eq 'penalty' ? column('dt_fs') : 1/0):'rms_distance_nm' with linespoints lc rgb '#8C564B' pt 4 lw 1.5 title 'penalty (order 1.87)', \
       csv using (strcol('method') eq 'baumgarte' ? column('dt_fs') : 1/0):'rms_distance_nm' with linespoints lc rgb '#D55E00' pt 7 lw 1.5 title 'baumgarte (order 1.76)', \
       csv using (strcol('method') eq 'feedforward' ? column('dt_fs') : 1/0):'rms_distance_nm' with linespoints lc rgb '#000000' pt 5 lw 1.5 title 'feedforward (order 1.76)', \
       csv using (strcol('method') eq 'shake' ? column('dt_fs') : 1/0):'rms_distance_nm' with linespoints lc rgb '#56B4E9' pt 8 lw 1.5 title 'shake (order 1.76)', \
       csv using (strcol('method') eq 'rattle' ? column('dt_fs') : 1/0):'rms_distance_nm' with linespoints lc rgb '#0072B2' pt 9 lw 1.5 title 'rattle (order 1.76)', \
       csv using (strcol('method') eq 'newton' ? column('dt_fs') : 1/0):'rms_distance_nm' with linespoints lc rgb '#009E73' pt 13 lw 1.5 title 'newton (order 1.76)', \
       csv using (strcol('method') eq 'lincs' ? column('dt_fs') : 1/0):'rms_distance_nm' with linespoints lc rgb '#CC79A7' pt 12 lw 1.5 title 'lincs (order 1.85)', \
       csv using (strcol('method') eq 'settle' ? column('dt_fs') : 1/0):'rms_distance_nm' with linespoints lc rgb '#E69F00' pt 11 lw 1.5 title 'settle (order 1.76)'
}
