# Draws each_run.svg and each_run.png from each_run.csv: `gnuplot each_run.gp` in this folder.
name = 'each_run'
load 'taut.gp'

# A panel a figure: the runs in their order, and a band for the mean and its error where the table has one.
array mean[200]
array error[200]
do for [k=1:200] { mean[k] = NaN; error[k] = NaN }
runs = 1
label(x) = strcol('figure').' ['.strcol('unit').']'
at(text) = sum [k=1:curves] (curve[k] eq text ? k : 0)
note_mean(k, v, e) = (mean[k] = v, error[k] = e, 0)
stats csv using (add_curve(label(0), strcol('figure'))) nooutput
eval expect_curves
stats csv using (column('number') == 0 ? note_mean(at(label(0)), column('value'), column('standard_error')) : \
  (runs = column('number') > runs ? column('number') : runs, 0)) nooutput
columns = curves < 3 ? curves : 3
rows = int((curves + columns - 1) / columns)
of(k) = at(label(0)) == k && column('number') > 0

do for [kind in 'svg png'] {
  eval page(kind, 340*columns, 60 + 260*rows)
  set multiplot layout rows, columns title title noenhanced
  unset key
  set xlabel 'run'
  set xtics 1
  do for [k=1:curves] {
    set title curve[k] noenhanced
    set xrange [0.5:runs + 0.5]
    set yrange [*:*]
    if (is_number(mean[k])) {
      set object 1 rectangle from graph 0, first mean[k] - error[k] to graph 1, first mean[k] + error[k] fc rgb '#0072B2' fs transparent solid 0.2 noborder behind
    }
    plot csv using (of(k) ? column('number') : 1/0):(of(k) ? column('value') : 1/0):(of(k) ? column('standard_error') : 1/0) with yerrorbars lc rgb '#000000' pt 7 ps 0.9 lw 1.5, \
         mean[k] with lines lc rgb '#0072B2' lw 1.5
    unset object 1
  }
  unset multiplot
}
