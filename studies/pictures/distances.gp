# Draws distances.svg and distances.png from distances.csv: `gnuplot distances.gp` in this folder.
name = 'distances'
load 'taut.gp'
stats csv using (add_curve(strcol('run'), word(strcol('run'), 1))) nooutput

do for [kind in 'svg png'] {
  eval page(kind, 800, 520)
  set title title noenhanced
  set xlabel 'r [nm]'
  set ylabel 'g(r)'
  set key noenhanced
  plot for [k=1:curves] csv using (strcol('run') eq curve[k] ? column('r_nm') : 1/0):'g':'standard_error' with yerrorlines lc rgb (own_colour(method[k]) == 0x777777 ? hue(k) : shade(k)) pt sign(k) dt dash(k) lw 1.5 ps 0.7 title curve[k]
}
