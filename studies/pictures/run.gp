# Draws run.svg and run.png from run.csv: `gnuplot run.gp` in this folder.
name = 'run'
load 'taut.gp'

# A panel for each name in the first column; in it a curve for each name in the second. A curve of the same run has
# the same colour in all panels.
array panel[50]
array first[50]
array last[50]
panels = 0
panel_at(text) = sum [k=1:panels] (panel[k] eq text ? k : 0)
note_panel(p) = panel_at(p) == 0 ? (panels = panels + 1, panel[panels] = p, 0) : 0
drawn(p, c) = p."\t".c
stats csv using (note_panel(strcol('panel')), add_curve(drawn(strcol('panel'), strcol('curve')), strcol('panel')), 0) nooutput
eval expect_curves
do for [k=1:curves] { p = panel_at(method[k]); if (number[k] == 0) { first[p] = k }; last[p] = k }
columns = panels < 2 ? panels : 2
rows = int((panels + columns - 1) / columns)
of(k) = drawn(strcol('panel'), strcol('curve')) eq curve[k]
short(k) = curve[k][strstrt(curve[k], "\t") + 1:]
run_hue(k) = hue(number[k] + 1)
light(p, k) = strstrt(panel[p], 'account') || is_log(p) ? run_hue(k) : blend(run_hue(k), 255, 0.55)  # a mean is drawn over it
is_log(p) = strstrt(panel[p], 'bond error') > 0

do for [kind in 'svg png'] {
  eval page(kind, 560*columns, 60 + 260*rows)
  set multiplot layout rows, columns title title noenhanced
  set xlabel 't [ps]'
  set key noenhanced top right
  do for [p=1:panels] {
    set title panel[p] noenhanced
    if (is_log(p)) { set logscale y; set format y '10^{%L}' } else { unset logscale y; set format y '%.6g' }
    plot for [k=first[p]:last[p]] csv using (of(k) ? column('t_ps') : 1/0):(of(k) ? column('value') : 1/0) with lines lc rgb light(p, k) lw 1 title short(k), \
         for [k=first[p]:last[p]] csv using (of(k) ? column('t_ps') : 1/0):(of(k) ? column('running_mean') : 1/0) with lines lc rgb run_hue(k) lw 2 notitle
  }
  unset multiplot
}
