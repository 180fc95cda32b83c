# Draws kinds.svg and kinds.png from kinds.csv: `gnuplot kinds.gp` in this folder.
name = 'kinds'
load 'taut.gp'

array run[200]
runs = 0
run_at(text) = sum [k=1:runs] (run[k] eq text ? k : 0)
note_run(r) = run_at(r) == 0 ? (runs = runs + 1, run[runs] = r, 0) : 0
array bath[200]
do for [k=1:200] { bath[k] = NaN }
note_bath(t) = (bath[run_at(strcol('run'))] = t, 0)
stats csv using (note_run(strcol('run')), strcol('kind') eq 'bath' ? note_bath(column('temperature_k')) : add_curve(strcol('kind'), strcol('kind')), 0) nooutput
eval expect_curves
kind_at(text) = sum [k=1:curves] (curve[k] eq text ? k : 0)
aside(r) = 0.5 * (r - (runs + 1) / 2.0) / runs

do for [kind in 'svg png'] {
  eval page(kind, 800, 420)
  set title title noenhanced
  set ylabel 'temperature [K]'
  set xrange [0.5:curves + 0.5]
  set xtics rotate by -20
  set xtics ()
  do for [k=1:curves] { set xtics add (curve[k] k) noenhanced }
  set key noenhanced outside right
  if (runs == 1) { set key inside top right }
  ours(r) = strcol('run') eq run[r] && strcol('kind') ne 'bath'
  plot for [r=1:runs] csv using (ours(r) ? kind_at(strcol('kind')) + aside(r) : 1/0):(ours(r) ? column('temperature_k') : 1/0):(ours(r) ? column('standard_error') : 1/0) with yerrorbars lc rgb hue(r) pt 7 ps 0.9 lw 1.5 title (runs == 1 ? '' : run[r]), \
       for [r=1:runs] bath[r] with lines lc rgb hue(r) lw 1.5 dt 2 title (is_number(bath[r]) ? (runs == 1 ? 'bath' : run[r].': bath') : '')
}
