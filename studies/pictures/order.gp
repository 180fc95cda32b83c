# Draws order.svg and order.png from order.csv: `gnuplot order.gp` in this folder.
name = 'order'
load 'taut.gp'
shortest = 1e9
longest = 0
step(h) = (shortest = h < shortest ? h : shortest, longest = h > longest ? h : longest)
named(method, order) = sprintf('%s (order %.2f)', method, order)
stats csv using (step(column('dt_fs')), is_number(column('order')) ? add_curve(named(strcol('method'), column('order')), strcol('method')) : 0) nooutput
eval expect_curves

do for [kind in 'svg png'] {
  eval page(kind, 800, 520)
  set title title noenhanced
  set logscale xy
  set format y '10^{%L}'
  set xrange [shortest / 1.25 : longest * 1.25]
  set xlabel 'step [fs]'
  set ylabel 'rms distance [nm]'
  set key noenhanced outside right samplen 2
  plot for [k=1:curves] csv using (strcol('method') eq method[k] ? column('dt_fs') : 1/0):'rms_distance_nm' with linespoints lc rgb colour(k) pt mark(k) lw 1.5 title curve[k]
}
