# The divergence of a Taylor–Green vortex: what a coarse pressure leaves, and how one that is put in decays.
call '../../worlds/style.gp' 'flow' 560
set multiplot layout 2,1
set logscale y
set format y '10^{%L}'
set ylabel 'rms divergence'
set key left bottom
set yrange [1e-9:1e-2]
set title 'pressure to 1e-3 by conjugate gradients'
plot csv using 'step':'bare' with lines lw 2 lc rgb grey title 'bare: D u̇ = 0', \
     csv using 'step':'baumgarte' with lines lw 2 lc rgb blue title 'baumgarte, dead-beat', \
     csv using 'step':'projection' with lines lw 2 lc rgb green title 'projection, a second solve'
set title 'put in at the start'
set xlabel 'step'
set yrange [1e-12:1]
plot csv using 'step':'put_in_weak' every 4 with points pt 6 ps 0.5 lc rgb orange title 'αh = 0.05, βh = 0.2', \
     csv using 'step':'foretold_weak' with lines lw 1 lc rgb black title 'foretold', \
     csv using 'step':'put_in_strong' with points pt 6 ps 0.5 lc rgb blue title 'αh = 0.3, (βh)² = 2.5', \
     csv using 'step':'foretold_strong' with lines lw 1 lc rgb black notitle
unset multiplot
