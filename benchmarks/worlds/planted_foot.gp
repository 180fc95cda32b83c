# A body vaulting over its foot: what the foot slides by, and the reaction of the ground.
call '../../worlds/style.gp' 'planted_foot' 560
set multiplot layout 2,1
set ylabel 'the foot slides by [mm]'
plot csv using 't_s':'none_mm' every 4 with points pt 6 ps 0.6 lc rgb grey title 'none: bare accelerations', \
     csv using 't_s':'foretold_mm' with lines lw 1.5 lc rgb black title 'foretold: σ₊ − 2σ + σ₋ = ¼h⁴|a|²', \
     csv using 't_s':'baumgarte_mm' with lines lw 2 lc rgb blue title 'baumgarte'
set xlabel 't [s]'
set ylabel 'reaction [N]'
set key right bottom
plot csv using 't_s':'closed_form_n' with lines lw 1.5 lc rgb black title 'm(g cos θ − v²/L)', \
     csv using 't_s':'reaction_n' every 4 with points pt 6 ps 0.6 lc rgb blue title 'along the leg'
unset multiplot
