# water: drawn from crosscheck.csv by `gnuplot crosscheck.gp` in this folder
csv = 'crosscheck.csv'
set datafile separator ','
set datafile columnheaders
set terminal svg size 900,540 background 'white'
set key outside right
set grid
set xlabel 't [ps]'
set logscale y
set format y '10^{%L}'

set xrange [0:0.8]
set output 'apart.svg'
set title 'water: apart from OpenMM''s run'
set ylabel 'largest distance [nm]'
plot csv using (strcol('run') eq 'openmm moved 1e-10' ? column('t_ps') : 1/0):(column('apart_nm') > 0 ? column('apart_nm') : 1/0) with lines title 'openmm moved 1e-10' dashtype 2, \
     csv using (strcol('run') eq 'openmm verlet' ? column('t_ps') : 1/0):(column('apart_nm') > 0 ? column('apart_nm') : 1/0) with lines title 'openmm verlet' dashtype 2, \
     csv using (strcol('run') eq 'newton' ? column('t_ps') : 1/0):(column('apart_nm') > 0 ? column('apart_nm') : 1/0) with lines title 'newton', \
     csv using (strcol('run') eq 'rattle' ? column('t_ps') : 1/0):(column('apart_nm') > 0 ? column('apart_nm') : 1/0) with lines title 'rattle', \
     csv using (strcol('run') eq 'feedforward' ? column('t_ps') : 1/0):(column('apart_nm') > 0 ? column('apart_nm') : 1/0) with lines title 'feedforward', \
     csv using (strcol('run') eq 'baumgarte reversible' ? column('t_ps') : 1/0):(column('apart_nm') > 0 ? column('apart_nm') : 1/0) with lines title 'baumgarte reversible'

set output 'fine.svg'
set title 'water: apart from the fine run'
set ylabel 'largest distance [nm]'
plot csv using (strcol('run') eq 'openmm rattle' ? column('t_ps') : 1/0):(column('from_fine_run_nm') > 0 ? column('from_fine_run_nm') : 1/0) with lines title 'openmm rattle', \
     csv using (strcol('run') eq 'openmm moved 1e-10' ? column('t_ps') : 1/0):(column('from_fine_run_nm') > 0 ? column('from_fine_run_nm') : 1/0) with lines title 'openmm moved 1e-10' dashtype 2, \
     csv using (strcol('run') eq 'openmm verlet' ? column('t_ps') : 1/0):(column('from_fine_run_nm') > 0 ? column('from_fine_run_nm') : 1/0) with lines title 'openmm verlet' dashtype 2, \
     csv using (strcol('run') eq 'newton' ? column('t_ps') : 1/0):(column('from_fine_run_nm') > 0 ? column('from_fine_run_nm') : 1/0) with lines title 'newton', \
     csv using (strcol('run') eq 'rattle' ? column('t_ps') : 1/0):(column('from_fine_run_nm') > 0 ? column('from_fine_run_nm') : 1/0) with lines title 'rattle', \
     csv using (strcol('run') eq 'feedforward' ? column('t_ps') : 1/0):(column('from_fine_run_nm') > 0 ? column('from_fine_run_nm') : 1/0) with lines title 'feedforward', \
     csv using (strcol('run') eq 'baumgarte reversible' ? column('t_ps') : 1/0):(column('from_fine_run_nm') > 0 ? column('from_fine_run_nm') : 1/0) with lines title 'baumgarte reversible'

set xrange [0:*]
set output 'bonds.svg'
set title 'water: bond errors'
set ylabel 'largest relative error'
plot csv using (strcol('run') eq 'openmm rattle' ? column('t_ps') : 1/0):(column('max_rel_bond_error') > 0 ? column('max_rel_bond_error') : 1/0) with lines title 'openmm rattle', \
     csv using (strcol('run') eq 'openmm moved 1e-10' ? column('t_ps') : 1/0):(column('max_rel_bond_error') > 0 ? column('max_rel_bond_error') : 1/0) with lines title 'openmm moved 1e-10' dashtype 2, \
     csv using (strcol('run') eq 'openmm verlet' ? column('t_ps') : 1/0):(column('max_rel_bond_error') > 0 ? column('max_rel_bond_error') : 1/0) with lines title 'openmm verlet' dashtype 2, \
     csv using (strcol('run') eq 'newton' ? column('t_ps') : 1/0):(column('max_rel_bond_error') > 0 ? column('max_rel_bond_error') : 1/0) with lines title 'newton', \
     csv using (strcol('run') eq 'rattle' ? column('t_ps') : 1/0):(column('max_rel_bond_error') > 0 ? column('max_rel_bond_error') : 1/0) with lines title 'rattle', \
     csv using (strcol('run') eq 'feedforward' ? column('t_ps') : 1/0):(column('max_rel_bond_error') > 0 ? column('max_rel_bond_error') : 1/0) with lines title 'feedforward', \
     csv using (strcol('run') eq 'baumgarte reversible' ? column('t_ps') : 1/0):(column('max_rel_bond_error') > 0 ? column('max_rel_bond_error') : 1/0) with lines title 'baumgarte reversible'

set output 'energy.svg'
set title 'water: total energy'
set ylabel 'E − E_0 [kJ/mol]'
unset logscale y
set format y '%g'
plot csv using (strcol('run') eq 'openmm rattle' ? column('t_ps') : 1/0):(column('energy_kj_mol') - -7083.62639298) with lines title 'openmm rattle', \
     csv using (strcol('run') eq 'newton' ? column('t_ps') : 1/0):(column('energy_kj_mol') - -7083.62407978) with lines title 'newton', \
     csv using (strcol('run') eq 'rattle' ? column('t_ps') : 1/0):(column('energy_kj_mol') - -7083.62407978) with lines title 'rattle', \
     csv using (strcol('run') eq 'feedforward' ? column('t_ps') : 1/0):(column('energy_kj_mol') - -7083.62407978) with lines title 'feedforward', \
     csv using (strcol('run') eq 'baumgarte reversible' ? column('t_ps') : 1/0):(column('energy_kj_mol') - -7083.62407978) with lines title 'baumgarte reversible'

set output 'distances.svg'
set title 'water: O–O radial distribution'
set ylabel 'g(r)'
set xlabel 'r [nm]'
plot 'distances.csv' using (strcol('run') eq 'openmm rattle' ? column('r_nm') : 1/0):'g':'standard_error' with yerrorlines title 'openmm rattle', \
     'distances.csv' using (strcol('run') eq 'newton' ? column('r_nm') : 1/0):'g':'standard_error' with lines title 'newton', \
     'distances.csv' using (strcol('run') eq 'rattle' ? column('r_nm') : 1/0):'g':'standard_error' with lines title 'rattle', \
     'distances.csv' using (strcol('run') eq 'feedforward' ? column('r_nm') : 1/0):'g':'standard_error' with lines title 'feedforward', \
     'distances.csv' using (strcol('run') eq 'baumgarte reversible' ? column('r_nm') : 1/0):'g':'standard_error' with lines title 'baumgarte reversible'

