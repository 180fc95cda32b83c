# Draws distances.svg and distances.png from distances.csv: `gnuplot distances.gp` in this folder.
csv = 'distances.csv'
set encoding utf8
do for [kind in 'svg png'] {
  reset
  set datafile separator ','
  set datafile columnheaders
  if (kind eq 'svg') {
    set terminal svg size 800,520 background 'white' font 'Helvetica,12'
  } else {
    set terminal pngcairo size 800,520 background 'white' font 'Helvetica,11'
  }
  set output 'distances.'.kind
  set grid lc rgb '#dddddd' lt 1
  set border lw 0.8
  set tics nomirror
  set title 'water: O–O radial distribution, bars: standard errors' noenhanced
  set xlabel 'r [nm]'
  set ylabel 'g(r)'
  set key noenhanced
  plot csv using (strcol('run') eq 'openmm rattle' ? column('r_nm') : 1/0):'g':'standard_error' with yerrorlines lc rgb '#777777' dt 1 lw 1.5 pt 1 title 'openmm rattle', \
       csv using (strcol('run') eq 'newton' ? column('r_nm') : 1/0):'g':'standard_error' with yerrorlines lc rgb '#009E73' pt 13 dt 1 lw 1.5 ps 0.7 title 'newton', \
       csv using (strcol('run') eq 'rattle' ? column('r_nm') : 1/0):'g':'standard_error' with yerrorlines lc rgb '#0072B2' pt 9 dt 1 lw 1.5 ps 0.7 title 'rattle', \
       csv using (strcol('run') eq 'feedforward' ? column('r_nm') : 1/0):'g':'standard_error' with yerrorlines lc rgb '#000000' pt 5 dt 1 lw 1.5 ps 0.7 title 'feedforward', \
       csv using (strcol('run') eq 'baumgarte reversible' ? column('r_nm') : 1/0):'g':'standard_error' with yerrorlines lc rgb '#D55E00' pt 7 dt 1 lw 1.5 ps 0.7 title 'baumgarte reversible'
}
