# Draws steps.svg and steps.png from steps.csv: `gnuplot steps.gp` in this folder.
name = 'steps'
load 'taut.gp'
stats csv using (column('column')):(column('row')) name 'last' nooutput
wrapped(s) = words(s) < 2 ? s : words(s) == 2 ? word(s, 1)."\n".word(s, 2) : words(s) == 3 ? word(s, 1).' '.word(s, 2)."\n".word(s, 3) : word(s, 1).' '.word(s, 2)."\n".word(s, 3).' '.word(s, 4)
long_as(x) = x > 0 ? sprintf('%.3g', x) : '–'

do for [kind in 'svg png'] {
  eval page(kind, 150 + 94 * (last_max_x + 1), 120 + 62 * (last_max_y + 1))
  set title title noenhanced
  set xrange [-0.5 : last_max_x + 0.5]
  set yrange [last_max_y + 0.5 : -0.5] noextend
  unset grid
  unset key
  unset colorbox
  set palette defined (0 '#aaaaaa', 1 '#ffffff')
  set cbrange [-3:0]
  set style fill solid border lc rgb '#888888'
  set xtics scale 0 noenhanced
  set ytics scale 0 noenhanced
  plot csv using 'column':'row':(column('column')-0.5):(column('column')+0.5):(column('row')-0.5):(column('row')+0.5):(log10(column('share_of_best') + 1e-3)):xticlabels(strcol('method')):yticlabels(strcol('scene')) with boxxyerror palette, \
       csv using (column('column')):(column('row')-0.25):(long_as(column('largest_stable_fs'))) with labels font ',11' noenhanced, \
       csv using (column('column')):(column('row')+0.17):(wrapped(strcol('fails_as'))) with labels font ',7' noenhanced
}
