# Draws scan.svg and scan.png from scan.csv: `gnuplot scan.gp` in this folder.
name = 'scan'
load 'taut.gp'

# A panel a figure: along x the first key that was varied, a curve for each setting of the others.
array figure[100]
figures = 0
x_name = ''
figure_at(text) = sum [k=1:figures] (figure[k] eq text ? k : 0)
label(x) = strcol('figure').' ['.strcol('unit').']'
note_figure(f) = figure_at(f) == 0 ? (figures = figures + 1, figure[figures] = f, 0) : 0
stats csv using (note_figure(label(0)), add_curve(strcol('curve'), strcol('method')), x_name = strcol('x_name'), 0) nooutput
eval expect_curves
# Values that are words stand at 1, 2, ...: their names are the tics.
array word_at[200]
words = 0
note_word(x, text) = text eq '-' ? 0 : (word_at[int(x)] = text, words = words < x ? x : words, 0)
stats csv using (note_word(column('x'), strcol('x_text'))) nooutput
columns = figures < 3 ? figures : 3
rows = int((figures + columns - 1) / columns)
of(f, k) = figure_at(label(0)) == f && strcol('curve') eq curve[k]

do for [kind in 'svg png'] {
  eval page(kind, 360*columns, 60 + 280*rows)
  set multiplot layout rows, columns title title noenhanced
  set xlabel x_name noenhanced
  set offsets graph 0.05, graph 0.05, 0, 0
  if (words > 0) { set xtics (); do for [k=1:words] { set xtics add (word_at[k] k) noenhanced } }
  set key noenhanced
  do for [f=1:figures] {
    set title figure[f] noenhanced
    if (f > 1 || curves == 1) { unset key }
    plot for [k=1:curves] csv using (of(f, k) ? column('x') : 1/0):(of(f, k) ? column('value') : 1/0):(of(f, k) ? column('standard_error') : 1/0) with yerrorlines lc rgb shade(k) pt sign(k) lw 1.5 ps 0.8 title curve[k]
  }
  unset multiplot
}
