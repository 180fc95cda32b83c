# Draws viscosity.svg and viscosity.png from viscosity.csv: `gnuplot viscosity.gp` in this folder.
name = 'viscosity'
load 'taut.gp'

cut = 0
longest = 0
stats csv using (cut = column('cut_ps'), longest = column('t_ps')) nooutput
shown = cut > 0 && 3*cut < longest ? 3*cut : longest

do for [kind in 'svg png'] {
  eval page(kind, 800, 520)
  set title title noenhanced
  set xlabel 't [ps]'
  set ylabel 'viscosity, the integral up to t [mPa s]'
  set y2label '⟨P(0)P(t)⟩/⟨P²⟩'
  set y2tics
  set y2range [-0.2:1]
  set xrange [0:shown]
  set yrange [0:*]
  set key right center noenhanced
  if (cut > 0) { set arrow 1 from cut, graph 0 to cut, graph 1 nohead lc rgb '#777777' dt 2 }
  low(v, e) = v - e
  plot csv using 't_ps':(column('viscosity_mpa_s') - column('standard_error')):(column('viscosity_mpa_s') + column('standard_error')) with filledcurves fc rgb '#0072B2' fs transparent solid 0.2 notitle, \
       csv using 't_ps':'viscosity_mpa_s' with lines lc rgb '#0072B2' lw 2 title 'viscosity', \
       csv using 't_ps':'correlation' axes x1y2 with lines lc rgb '#D55E00' lw 1.5 title 'correlation', \
       1/0 with lines lc rgb '#777777' dt 2 title (cut > 0 ? 'where it is read' : '')
}
