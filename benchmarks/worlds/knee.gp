# A minute of a swinging knee: its ligaments and its energy.
call '../../worlds/style.gp' 'knee' 560
set multiplot layout 2,1
set logscale y
set format y '10^{%L}'
set yrange [1e-10:100]
set ylabel 'ligaments off by at most [mm]'
set key center right
plot csv using 't_s':'none_mm' with lines lw 2 lc rgb grey title 'none', \
     csv using 't_s':'physical_mm' with lines lw 2 lc rgb orange title 'α = β = √(k/I)', \
     csv using 't_s':'calibrated_mm' with lines lw 2 lc rgb blue title 'calibrated: αh = 0.3, (βh)² = 2.5'
unset logscale y
set format y '%g'
set yrange [-6.0:-5.7]
set xlabel 't [s]'
set ylabel 'energy [J]'
set key left top
plot csv using 't_s':'none_energy' with lines lw 2 lc rgb grey title 'none', \
     csv using 't_s':'physical_energy' with lines lw 2 lc rgb orange title 'α = β = √(k/I)', \
     csv using 't_s':'calibrated_energy' with lines lw 2 lc rgb blue title 'calibrated'
unset multiplot
