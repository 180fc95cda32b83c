# A sheet folding up: how near its layers come, in thicknesses. Below 1 they pass into, below 0 through each other.
call '../../worlds/style.gp' 'fold' 360
set xlabel 't [ps]'
set ylabel 'nearest layers [thicknesses]'
set yrange [-8:16]
set key right top
plot csv using 't_ps':'without' with lines lw 2 lc rgb grey title 'no struts', \
     csv using 't_ps':'none' with lines lw 2 lc rgb orange title 'struts without a corrective term', \
     csv using 't_ps':'baumgarte' with lines lw 3 lc rgb sky title 'baumgarte', \
     csv using 't_ps':'newton' with lines lw 1 lc rgb black title 'newton', \
     1 with lines dt 3 lc rgb black notitle
