# Draws kinds.svg and kinds.png from kinds.csv: `gnuplot kinds.gp` in this folder.
name = 'kinds'
load 'taut.gp'

array run[200]
runs = 0
run_at(text) = sum [k=1:runs] (run[k] eq text ? k : 0)
note_run(r) = run_at(r) == 0 ? (runs = runs + 1, run[runs] = r, 0) : 0
stats csv using (note_run(strcol('run')), add_curve(strcol('kind'), strcol('kind')), 0) nooutput
eval expect_curves
kind_at(text) = sum [k=1:curves] (curve[k] eq text ? k : 0)
hues = '0x0072B2 0xD55E00 0x009E73 0xCC79A7 0xE69F00 0x56B4E9 0x000000 0x8C564B'
hue(k) = int(word(hues, (k - 1) % 8 + 1))
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
  if (runs == 1) { unset key }
  plot for [r=1:runs] csv using (strcol('run') eq run[r] ? kind_at(strcol('kind')) + aside(r) : 1/0):(strcol('run') eq run[r] ? column('temperature_k') : 1/0):(strcol('run') eq run[r] ? column('standard_error') : 1/0) with yerrorbars lc rgb hue(r) pt 7 ps 0.9 lw 1.5 title run[r]
}
