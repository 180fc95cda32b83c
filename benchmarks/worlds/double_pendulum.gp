# What damping gives a double pendulum, against the closed form.
call '../../worlds/style.gp' 'double_pendulum' 360
set xlabel 't [ps]'
set ylabel 'energy given [kJ/mol]'
plot for [k=1:3] csv using 't_ps':(column('implicit_'.word('0.1 0.3 1', k)) - column('discrete')) every 6 with points pt 6 ps 0.5 lc rgb word(sky.' '.blue.' '.orange, k) title 'implicit, αh = '.word('0.1 0.3 1', k).', over discrete', \
     for [k=1:3] csv using 't_ps':'foretold_'.word('0.1 0.3 1', k) with lines lw 1.5 lc rgb word(sky.' '.blue.' '.orange, k) title k == 1 ? '−(αh)h³/(βh)² ∫ Σ λ̇ v·a dt' : '', \
     csv using 't_ps':(column('centred') - column('discrete')) with lines lw 1.5 lc rgb green title 'centred, over discrete'
