# Draws crosscheck.svg and crosscheck.png from crosscheck.csv: `gnuplot crosscheck.gp` in this folder.
csv = 'crosscheck.csv'
set encoding utf8
do for [kind in 'svg png'] {
  reset
  set datafile separator ','
  set datafile columnheaders
  if (kind eq 'svg') {
    set terminal svg size 1000,860 background 'white' font 'Helvetica,12'
  } else {
    set terminal pngcairo size 1000,860 background 'white' font 'Helvetica,11'
  }
  set output 'crosscheck.'.kind
  set grid lc rgb '#dddddd' lt 1
  set border lw 0.8
  set tics nomirror
  set multiplot layout 2,2 title 'water: taut against OpenMM 7.7, CPU' noenhanced margins 0.08,0.98,0.2,0.92 spacing 0.1,0.1
  set xlabel 't [ps]'
  set key noenhanced at screen 0.5,0.005 center bottom maxrows 4 samplen 3 width 1
  set xrange [0:0.8]
  set logscale y
  set format y '10^{%L}'
  seen(y) = y != 0 ? abs(y) : 1/0
  set title 'apart from OpenMM''s run'
  set ylabel 'largest distance [nm]'
  plot csv using (strcol('run') eq 'openmm verlet' ? column('t_ps') : 1/0):(seen(column('apart_nm') - 0)) with linespoints pi -8 lc rgb '#777777' dt 2 lw 1.5 pt 2 notitle, \
       csv using (strcol('run') eq 'openmm moved 1e-10' ? column('t_ps') : 1/0):(seen(column('apart_nm') - 0)) with linespoints pi -8 lc rgb '#777777' dt 3 lw 1.5 pt 3 notitle, \
       csv using (strcol('run') eq 'newton' ? column('t_ps') : 1/0):(seen(column('apart_nm') - 0)) with linespoints pi -8 lc rgb '#009E73' pt 13 dt 1 lw 1.5 ps 0.7 notitle, \
       csv using (strcol('run') eq 'rattle' ? column('t_ps') : 1/0):(seen(column('apart_nm') - 0)) with linespoints pi -8 lc rgb '#0072B2' pt 9 dt 1 lw 1.5 ps 0.7 notitle, \
       csv using (strcol('run') eq 'feedforward' ? column('t_ps') : 1/0):(seen(column('apart_nm') - 0)) with linespoints pi -8 lc rgb '#000000' pt 5 dt 1 lw 1.5 ps 0.7 notitle, \
       csv using (strcol('run') eq 'baumgarte reversible' ? column('t_ps') : 1/0):(seen(column('apart_nm') - 0)) with linespoints pi -8 lc rgb '#D55E00' pt 7 dt 1 lw 1.5 ps 0.7 notitle
  set title 'apart from the fine run'
  set ylabel 'largest distance [nm]'
  plot csv using (strcol('run') eq 'openmm rattle' ? column('t_ps') : 1/0):(seen(column('from_fine_run_nm') - 0)) with linespoints pi -8 lc rgb '#777777' dt 1 lw 1.5 pt 1 title 'openmm rattle', \
       csv using (strcol('run') eq 'openmm verlet' ? column('t_ps') : 1/0):(seen(column('from_fine_run_nm') - 0)) with linespoints pi -8 lc rgb '#777777' dt 2 lw 1.5 pt 2 title 'openmm verlet', \
       csv using (strcol('run') eq 'openmm moved 1e-10' ? column('t_ps') : 1/0):(seen(column('from_fine_run_nm') - 0)) with linespoints pi -8 lc rgb '#777777' dt 3 lw 1.5 pt 3 title 'openmm moved 1e-10', \
       csv using (strcol('run') eq 'newton' ? column('t_ps') : 1/0):(seen(column('from_fine_run_nm') - 0)) with linespoints pi -8 lc rgb '#009E73' pt 13 dt 1 lw 1.5 ps 0.7 title 'newton', \
       csv using (strcol('run') eq 'rattle' ? column('t_ps') : 1/0):(seen(column('from_fine_run_nm') - 0)) with linespoints pi -8 lc rgb '#0072B2' pt 9 dt 1 lw 1.5 ps 0.7 title 'rattle', \
       csv using (strcol('run') eq 'feedforward' ? column('t_ps') : 1/0):(seen(column('from_fine_run_nm') - 0)) with linespoints pi -8 lc rgb '#000000' pt 5 dt 1 lw 1.5 ps 0.7 title 'feedforward', \
       csv using (strcol('run') eq 'baumgarte reversible' ? column('t_ps') : 1/0):(seen(column('from_fine_run_nm') - 0)) with linespoints pi -8 lc rgb '#D55E00' pt 7 dt 1 lw 1.5 ps 0.7 title 'baumgarte reversible'
  unset key
  set xrange [0:*]
  set title 'bond errors'
  set ylabel 'largest relative error'
  plot csv using (strcol('run') eq 'openmm rattle' ? column('t_ps') : 1/0):(seen(column('max_rel_bond_error') - 0)) with linespoints pi -8 lc rgb '#777777' dt 1 lw 1.5 pt 1 notitle, \
       csv using (strcol('run') eq 'openmm verlet' ? column('t_ps') : 1/0):(seen(column('max_rel_bond_error') - 0)) with linespoints pi -8 lc rgb '#777777' dt 2 lw 1.5 pt 2 notitle, \
       csv using (strcol('run') eq 'openmm moved 1e-10' ? column('t_ps') : 1/0):(seen(column('max_rel_bond_error') - 0)) with linespoints pi -8 lc rgb '#777777' dt 3 lw 1.5 pt 3 notitle, \
       csv using (strcol('run') eq 'newton' ? column('t_ps') : 1/0):(seen(column('max_rel_bond_error') - 0)) with linespoints pi -8 lc rgb '#009E73' pt 13 dt 1 lw 1.5 ps 0.7 notitle, \
       csv using (strcol('run') eq 'rattle' ? column('t_ps') : 1/0):(seen(column('max_rel_bond_error') - 0)) with linespoints pi -8 lc rgb '#0072B2' pt 9 dt 1 lw 1.5 ps 0.7 notitle, \
       csv using (strcol('run') eq 'feedforward' ? column('t_ps') : 1/0):(seen(column('max_rel_bond_error') - 0)) with linespoints pi -8 lc rgb '#000000' pt 5 dt 1 lw 1.5 ps 0.7 notitle, \
       csv using (strcol('run') eq 'baumgarte reversible' ? column('t_ps') : 1/0):(seen(column('max_rel_bond_error') - 0)) with linespoints pi -8 lc rgb '#D55E00' pt 7 dt 1 lw 1.5 ps 0.7 notitle
  set title 'total energy'
  set ylabel '|E − E_0| [kJ/mol]'
  plot csv using (strcol('run') eq 'openmm rattle' ? column('t_ps') : 1/0):(seen(column('energy_kj_mol') - -7083.62639298)) with linespoints pi -8 lc rgb '#777777' dt 1 lw 1.5 pt 1 notitle, \
       csv using (strcol('run') eq 'openmm verlet' ? column('t_ps') : 1/0):(seen(column('energy_kj_mol') - -7083.62639298)) with linespoints pi -8 lc rgb '#777777' dt 2 lw 1.5 pt 2 notitle, \
       csv using (strcol('run') eq 'openmm moved 1e-10' ? column('t_ps') : 1/0):(seen(column('energy_kj_mol') - -7083.62619462)) with linespoints pi -8 lc rgb '#777777' dt 3 lw 1.5 pt 3 notitle, \
       csv using (strcol('run') eq 'newton' ? column('t_ps') : 1/0):(seen(column('energy_kj_mol') - -7083.62407978)) with linespoints pi -8 lc rgb '#009E73' pt 13 dt 1 lw 1.5 ps 0.7 notitle, \
       csv using (strcol('run') eq 'rattle' ? column('t_ps') : 1/0):(seen(column('energy_kj_mol') - -7083.62407978)) with linespoints pi -8 lc rgb '#0072B2' pt 9 dt 1 lw 1.5 ps 0.7 notitle, \
       csv using (strcol('run') eq 'feedforward' ? column('t_ps') : 1/0):(seen(column('energy_kj_mol') - -7083.62407978)) with linespoints pi -8 lc rgb '#000000' pt 5 dt 1 lw 1.5 ps 0.7 notitle, \
       csv using (strcol('run') eq 'baumgarte reversible' ? column('t_ps') : 1/0):(seen(column('energy_kj_mol') - -7083.62407978)) with linespoints pi -8 lc rgb '#D55E00' pt 7 dt 1 lw 1.5 ps 0.7 notitle
  unset multiplot
}
