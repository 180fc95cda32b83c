# What a step pumps into a swing over the swing's energy, in units of A²: gnuplot constraints/pumping.gp
set terminal svg size 760,420 font 'sans,13'
set output 'constraints/pumping.svg'
pumped(w, ah, bb) = 2 * ah * sin(w / 2)**4 * sin(2 * w)**2 / ((bb - 2 + 2 * cos(2 * w))**2 + (2 * ah * sin(2 * w))**2)
set xrange [0.1:1.2]
set yrange [1e-7:0.1]
set logscale y
set format y '10^{%L}'
set samples 1000
set xlabel 'ωh, the vibration''s phase a step'
set ylabel 'energy gained a step / (A² energy)'
set key left top Left reverse
set arrow from 0.53, graph 0 to 0.53, graph 0.45 nohead dt 3
set arrow from 0.60, graph 0 to 0.60, graph 0.45 nohead dt 3
set label 'hydrogens bending, 2 fs' at 0.61, 3e-7
plot pumped(x, 0.1, 2) title 'centred, αh = 0.1, (βh)² = 2' lw 2 lc rgb '#222255', \
     pumped(x, 0.1, 3) title 'αh = 0.1, (βh)² = 3' lw 2 dt 2 lc rgb '#7788bb', \
     pumped(x, 0.02, 2.5) title 'αh = 0.02, (βh)² = 2.5' lw 2 dt 4 lc rgb '#dd7733', \
     pumped(x, 1, 2) title 'αh = 1, (βh)² = 2 (dead-beat)' lw 2 dt 5 lc rgb '#441122'
