# Draws precision.svg and precision.png from precision.csv: `gnuplot precision.gp` in this folder.
name = 'precision'
load 'taut.gp'
named(method, precision) = method.', '.precision
stats csv using (is_number(column('step_us')) ? add_curve(named(strcol('method'), strcol('precision')), strcol('method')) : 0) nooutput
eval expect_curves
is_mixed(k) = strstrt(curve[k], ', mixed') > 0
pattern(k) = is_mixed(k) ? 3 : 1

do for [kind in 'svg png'] {
  eval page(kind, 800, 520)
  set title title noenhanced
  set logscale x
  set format x '10^{%L}'
  set xrange [1e-4:*]
  set yrange [0:*]
  set xlabel drift_label
  set ylabel 'time of a step [µs]'
  set key noenhanced outside right samplen 2
  is(k) = named(strcol('method'), strcol('precision')) eq curve[k]
  plot for [k=1:curves] csv using (only_if(is(k), @at_drift)):'step_us':'step_us_q1':'step_us_q3' with yerrorbars lc rgb colour(k) pt mark(k) dt pattern(k) ps (is_mixed(k) ? 0.6 : 1) lw 1.5 title curve[k], \
       for [k=1:curves] csv using (only_if(is(k) && !has_zero(column('drift_low'), column('drift_high')), @at_drift)):'step_us':(low(column('drift_low'), column('drift_high'))):(high(column('drift_low'), column('drift_high'))) with xerrorbars lc rgb colour(k) pt mark(k) dt pattern(k) ps (is_mixed(k) ? 0.6 : 1) lw 1.5 notitle, \
       for [k=1:curves] csv using (only_if(is(k) && has_zero(column('drift_low'), column('drift_high')), @at_drift)):'step_us':(-arrow_share * @at_drift):(0) with vectors head size screen 0.007,20 filled lc rgb colour(k) dt pattern(k) lw 1.5 notitle
}
