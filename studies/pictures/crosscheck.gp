# Draws crosscheck.svg and crosscheck.png from crosscheck.csv: `gnuplot crosscheck.gp` in this folder.
name = 'crosscheck'
load 'taut.gp'

array start[200]  # each run's energy there
energy = 0
end = 0           # of runs that only explain [ps]
sampled(run, t, e) = (energy = t == 0 ? e : energy, end = strstrt(run, ' moved ') > 0 ? t : end, \
  t > 0 && strstrt(run, ' at h/') == 0 && add_curve(run, word(run, 1)) ? (start[curves] = energy) : 0)
stats csv using (sampled(strcol('run'), column('t_ps'), column('energy_kj_mol'))) nooutput
eval expect_curves
seen(y) = y != 0 && column('t_ps') > 0 ? abs(y) : 1/0  # at the start all is round-off
# Runs of one method differ by hue here, for they lie close together.
hue(k) = number[k] > 0 && method[k] eq 'baumgarte' ? int(word('0xE6AB02 0xAA3377 0x882255 0x66A61E 0x332288 0xF781BF 0x8C564B', number[k])) : shade(k)
# A row in so many has a mark, each run others, so that none hides another.
marked(k) = int(column(0)) % (2 * curves) == 2 * (k - 1)

from(k) = y eq 'energy_kj_mol' ? start[k] : 0
panel = "for [k=1:curves] csv using (strcol('run') eq curve[k] ? column('t_ps') : 1/0):(seen(column(y) - from(k))) with lines lc rgb hue(k) dt dash(k) lw 1.7 notitle, for [k=1:curves] csv using (strcol('run') eq curve[k] && marked(k) ? column('t_ps') : 1/0):(seen(column(y) - from(k))) with points lc rgb hue(k) pt sign(k) ps 1.2 notitle"

do for [kind in 'svg png'] {
  eval page(kind, 1100, 1000)
  set multiplot layout 2,2 title title noenhanced margins 0.08,0.98,0.17,0.94 spacing 0.1,0.1
  set xlabel 't [ps]'
  set logscale y
  set format y '10^{%L}'
  set key noenhanced at screen 0.5,0.01 center bottom maxrows 4 samplen 5 width 2

  set xrange [0:end]
  set title 'apart from OpenMM''s run'
  set ylabel 'largest distance [nm]'
  y = 'apart_nm'
  plot @panel, for [k=1:curves] keyentry with linespoints lc rgb hue(k) pt sign(k) dt dash(k) lw 1.5 title curve[k]
  set title 'apart from the fine run (on one line: apart by the step alone)'
  y = 'from_fine_run_nm'
  plot @panel

  set xrange [0:*]
  set title 'bond errors'
  set ylabel 'largest relative error'
  y = 'max_rel_bond_error'
  plot @panel
  set title 'total energy'
  set ylabel '|E − E_0| [kJ/mol]'
  y = 'energy_kj_mol'
  plot @panel
  unset multiplot
}
