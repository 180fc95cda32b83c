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

set xrange [0:0.2]
set output 'apart.svg'
set title 'water: apart from OpenMM''s run'
set ylabel 'largest distance [nm]'
plot csv using (strcol('run') eq 'openmm moved 1e-10' ? column('t_ps') : 1/0):(column('apart_nm') > 0 ? column('apart_nm') : 1/0) with lines title 'openmm moved 1e-10' dashtype 2, \
     csv using (strcol('run') eq 'openmm verlet' ? column('t_ps') : 1/0):(column('apart_nm') > 0 ? column('apart_nm') : 1/0) with lines title 'openmm verlet' dashtype 2, \
     csv using (strcol('run') eq 'newton' ? column('t_ps') : 1/0):(column('apart_nm') > 0 ? column('apart_nm') : 1/0) with lines title 'newton', \
     csv using (strcol('run') eq 'rattle' ? column('t_ps') : 1/0):(column('apart_nm') > 0 ? column('apart_nm') : 1/0) with lines title 'rattle', \
     csv using (strcol('run') eq 'feedforward' ? column('t_ps') : 1/0):(column('apart_nm') > 0 ? column('apart_nm') : 1/0) with lines title 'feedforward', \
     csv using (strcol('run') eq 'baumgarte reversible' ? column('t_ps') : 1/0):(column('apart_nm') > 0 ? column('apart_nm') : 1/0) with lines title 'baumgarte reversible', \
     csv using (strcol('run') eq 'baumgarte dead-beat' ? column('t_ps') : 1/0):(column('apart_nm') > 0 ? column('apart_nm') : 1/0) with lines title 'baumgarte dead-beat', \
     csv using (strcol('run') eq 'baumgarte rattle' ? column('t_ps') : 1/0):(column('apart_nm') > 0 ? column('apart_nm') : 1/0) with lines title 'baumgarte rattle', \
     csv using (strcol('run') eq 'baumgarte critical' ? column('t_ps') : 1/0):(column('apart_nm') > 0 ? column('apart_nm') : 1/0) with lines title 'baumgarte critical', \
     csv using (strcol('run') eq 'baumgarte physical' ? column('t_ps') : 1/0):(column('apart_nm') > 0 ? column('apart_nm') : 1/0) with lines title 'baumgarte physical', \
     csv using (strcol('run') eq 'baumgarte box2d' ? column('t_ps') : 1/0):(column('apart_nm') > 0 ? column('apart_nm') : 1/0) with lines title 'baumgarte box2d', \
     csv using (strcol('run') eq 'none' ? column('t_ps') : 1/0):(column('apart_nm') > 0 ? column('apart_nm') : 1/0) with lines title 'none'

set output 'fine.svg'
set title 'water: apart from the fine run'
set ylabel 'largest distance [nm]'
plot csv using (strcol('run') eq 'openmm rattle' ? column('t_ps') : 1/0):(column('from_fine_run_nm') > 0 ? column('from_fine_run_nm') : 1/0) with lines title 'openmm rattle', \
     csv using (strcol('run') eq 'openmm moved 1e-10' ? column('t_ps') : 1/0):(column('from_fine_run_nm') > 0 ? column('from_fine_run_nm') : 1/0) with lines title 'openmm moved 1e-10' dashtype 2, \
     csv using (strcol('run') eq 'openmm verlet' ? column('t_ps') : 1/0):(column('from_fine_run_nm') > 0 ? column('from_fine_run_nm') : 1/0) with lines title 'openmm verlet' dashtype 2, \
     csv using (strcol('run') eq 'newton' ? column('t_ps') : 1/0):(column('from_fine_run_nm') > 0 ? column('from_fine_run_nm') : 1/0) with lines title 'newton', \
     csv using (strcol('run') eq 'rattle' ? column('t_ps') : 1/0):(column('from_fine_run_nm') > 0 ? column('from_fine_run_nm') : 1/0) with lines title 'rattle', \
     csv using (strcol('run') eq 'feedforward' ? column('t_ps') : 1/0):(column('from_fine_run_nm') > 0 ? column('from_fine_run_nm') : 1/0) with lines title 'feedforward', \
     csv using (strcol('run') eq 'baumgarte reversible' ? column('t_ps') : 1/0):(column('from_fine_run_nm') > 0 ? column('from_fine_run_nm') : 1/0) with lines title 'baumgarte reversible', \
     csv using (strcol('run') eq 'baumgarte dead-beat' ? column('t_ps') : 1/0):(column('from_fine_run_nm') > 0 ? column('from_fine_run_nm') : 1/0) with lines title 'baumgarte dead-beat', \
     csv using (strcol('run') eq 'baumgarte rattle' ? column('t_ps') : 1/0):(column('from_fine_run_nm') > 0 ? column('from_fine_run_nm') : 1/0) with lines title 'baumgarte rattle', \
     csv using (strcol('run') eq 'baumgarte critical' ? column('t_ps') : 1/0):(column('from_fine_run_nm') > 0 ? column('from_fine_run_nm') : 1/0) with lines title 'baumgarte critical', \
     csv using (strcol('run') eq 'baumgarte physical' ? column('t_ps') : 1/0):(column('from_fine_run_nm') > 0 ? column('from_fine_run_nm') : 1/0) with lines title 'baumgarte physical', \
     csv using (strcol('run') eq 'baumgarte box2d' ? column('t_ps') : 1/0):(column('from_fine_run_nm') > 0 ? column('from_fine_run_nm') : 1/0) with lines title 'baumgarte box2d', \
     csv using (strcol('run') eq 'none' ? column('t_ps') : 1/0):(column('from_fine_run_nm') > 0 ? column('from_fine_run_nm') : 1/0) with lines title 'none'

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
     csv using (strcol('run') eq 'baumgarte reversible' ? column('t_ps') : 1/0):(column('max_rel_bond_error') > 0 ? column('max_rel_bond_error') : 1/0) with lines title 'baumgarte reversible', \
     csv using (strcol('run') eq 'baumgarte dead-beat' ? column('t_ps') : 1/0):(column('max_rel_bond_error') > 0 ? column('max_rel_bond_error') : 1/0) with lines title 'baumgarte dead-beat', \
     csv using (strcol('run') eq 'baumgarte rattle' ? column('t_ps') : 1/0):(column('max_rel_bond_error') > 0 ? column('max_rel_bond_error') : 1/0) with lines title 'baumgarte rattle', \
     csv using (strcol('run') eq 'baumgarte critical' ? column('t_ps') : 1/0):(column('max_rel_bond_error') > 0 ? column('max_rel_bond_error') : 1/0) with lines title 'baumgarte critical', \
     csv using (strcol('run') eq 'baumgarte physical' ? column('t_ps') : 1/0):(column('max_rel_bond_error') > 0 ? column('max_rel_bond_error') : 1/0) with lines title 'baumgarte physical', \
     csv using (strcol('run') eq 'baumgarte box2d' ? column('t_ps') : 1/0):(column('max_rel_bond_error') > 0 ? column('max_rel_bond_error') : 1/0) with lines title 'baumgarte box2d', \
     csv using (strcol('run') eq 'none' ? column('t_ps') : 1/0):(column('max_rel_bond_error') > 0 ? column('max_rel_bond_error') : 1/0) with lines title 'none'

set output 'energy.svg'
set title 'water: total energy'
set ylabel 'E − E_0 [kJ/mol]'
unset logscale y
set format y '%g'
plot csv using (strcol('run') eq 'openmm rattle' ? column('t_ps') : 1/0):(column('energy_kj_mol') - -7083.62407978) with lines title 'openmm rattle', \
     csv using (strcol('run') eq 'newton' ? column('t_ps') : 1/0):(column('energy_kj_mol') - -7083.62407978) with lines title 'newton', \
     csv using (strcol('run') eq 'rattle' ? column('t_ps') : 1/0):(column('energy_kj_mol') - -7083.62407978) with lines title 'rattle', \
     csv using (strcol('run') eq 'feedforward' ? column('t_ps') : 1/0):(column('energy_kj_mol') - -7083.62407978) with lines title 'feedforward', \
     csv using (strcol('run') eq 'baumgarte reversible' ? column('t_ps') : 1/0):(column('energy_kj_mol') - -7083.62407978) with lines title 'baumgarte reversible', \
     csv using (strcol('run') eq 'baumgarte dead-beat' ? column('t_ps') : 1/0):(column('energy_kj_mol') - -7083.62407978) with lines title 'baumgarte dead-beat', \
     csv using (strcol('run') eq 'baumgarte rattle' ? column('t_ps') : 1/0):(column('energy_kj_mol') - -7083.62407978) with lines title 'baumgarte rattle', \
     csv using (strcol('run') eq 'baumgarte critical' ? column('t_ps') : 1/0):(column('energy_kj_mol') - -7083.62407978) with lines title 'baumgarte critical', \
     csv using (strcol('run') eq 'baumgarte physical' ? column('t_ps') : 1/0):(column('energy_kj_mol') - -7083.62407978) with lines title 'baumgarte physical', \
     csv using (strcol('run') eq 'baumgarte box2d' ? column('t_ps') : 1/0):(column('energy_kj_mol') - -7083.62407978) with lines title 'baumgarte box2d', \
     csv using (strcol('run') eq 'none' ? column('t_ps') : 1/0):(column('energy_kj_mol') - -7083.62407978) with lines title 'none'

