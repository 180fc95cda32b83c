# Draws run.svg and run.png from run.csv: `gnuplot run.gp` in this folder.
name = 'run'
load 'taut.gp'

# A panel for each name in the first column; in it a curve for each name in the second.
array panel[100]
array first[100]
array last[100]
array averaged[1000]  # whether a mean is drawn over the curve
panels = 0
panel_at(text) = sum [k=1:panels] (panel[k] eq text ? k : 0)
note_panel(p) = panel_at(p) == 0 ? (panels = panels + 1, panel[panels] = p, 0) : 0
drawn(p, c) = p."\t".c
stats csv using (note_panel(strcol('panel')), add_curve(drawn(strcol('panel'), strcol('curve')), strcol('panel')), averaged[curves] = is_number(column('running_mean')), 0) nooutput
eval expect_curves
do for [k=1:curves] { p = panel_at(method[k]); if (number[k] == 0) { first[p] = k }; last[p] = k }
columns = panels < 2 ? panels : 2
rows = int((panels + columns - 1) / columns)
of(k) = drawn(strcol('panel'), strcol('curve')) eq curve[k]
short(k) = curve[k][strstrt(curve[k], "\t") + 1:]

# Curves of several runs are called "run" and "run: what": a run has one colour in all panels, its second curve is
# dashed. The first panel names the runs.
colon(k) = strstrt(short(k), ': ')
run_of(k) = colon(k) ? short(k)[:colon(k) - 1] : short(k)
what(k) = colon(k) ? short(k)[colon(k) + 2:] : ''
array run[1000]
runs = 0
run_at(text) = sum [k=1:runs] (run[k] eq text ? k : 0)
do for [k=first[1]:last[1]] { if (run_at(run_of(k)) == 0) { runs = runs + 1; run[runs] = run_of(k) } }
several = runs > 1
first_of_run(p, k) = (sum [j=first[p]:last[p]] (j < k && run_of(j) eq run_of(k))) == 0
line_hue(p, k) = several ? hue(run_at(run_of(k))) : hue(number[k] + 1)
line_dash(p, k) = several && !first_of_run(p, k) ? 2 : 1
label(p, k) = !several ? short(k) : p == 1 ? run_of(k) : run_at(run_of(k)) == 1 ? what(k) : ''
light(p, k) = averaged[k] ? blend(line_hue(p, k), 255, 0.55) : line_hue(p, k)
is_log(p) = strstrt(panel[p], 'bond error') > 0

do for [kind in 'svg png'] {
  eval page(kind, 560*columns, 60 + 260*rows)
  set multiplot layout rows, columns title title noenhanced
  set xlabel 't [ps]'
  do for [p=1:panels] {
    set title panel[p] noenhanced
    if (p == 1 && runs > 6) { set key noenhanced top right font ',7' } else { set key noenhanced top right font ',11' }
    if (is_log(p)) { set logscale y; set format y '10^{%L}' } else { unset logscale y; set format y '%.6g' }
    plot for [k=first[p]:last[p]] csv using (of(k) ? column('t_ps') : 1/0):(of(k) ? column('value') : 1/0) with lines lc rgb light(p, k) lw 1 dt line_dash(p, k) title label(p, k), \
         for [k=first[p]:last[p]] csv using (of(k) ? column('t_ps') : 1/0):(of(k) ? column('running_mean') : 1/0) with lines lc rgb line_hue(p, k) lw 2 notitle
  }
  unset multiplot
}
