# Draws steps.svg and steps.png from steps.csv: `gnuplot steps.gp` in this folder.
csv = 'steps.csv'
set encoding utf8
do for [kind in 'svg png'] {
  reset
  set datafile separator ','
  set datafile columnheaders
  if (kind eq 'svg') {
    set terminal svg size 900,616 background 'white' font 'Helvetica,12'
  } else {
    set terminal pngcairo size 900,616 background 'white' font 'Helvetica,11'
  }
  set output 'steps.'.kind
  set grid lc rgb '#dddddd' lt 1
  set border lw 0.8
  set tics nomirror
  set title 'Largest stable step [fs], and how the next one fails' noenhanced
  set xrange [-0.5:8.5]
  set yrange [7.5:-0.5] noextend
  unset grid
  unset key
  unset colorbox
  set palette defined (0 '#aaaaaa', 1 '#ffffff')
  set cbrange [-3:0]
  set style fill solid border lc rgb '#888888'
  set xtics scale 0 ('none' 0, 'penalty' 1, 'baumgarte' 2, 'feedforward' 3, 'shake' 4, 'rattle' 5, 'newton' 6, 'lincs' 7, 'settle' 8) noenhanced
  set ytics scale 0 ('freely_jointed' 0, 'across_box' 1, 'flat_ring' 2, 'hot_hydrogens' 3, 'long_chain' 4, 'mass_ratio' 5, 'off_manifold' 6, 'straight' 7) noenhanced
  wrapped(s) = words(s) < 2 ? s : words(s) == 2 ? word(s, 1)."\n".word(s, 2) : words(s) == 3 ? word(s, 1).' '.word(s, 2)."\n".word(s, 3) : word(s, 1).' '.word(s, 2)."\n".word(s, 3).' '.word(s, 4)
  long_as(x) = x > 0 ? sprintf('%.3g', x) : '–'
  plot csv using 'column':'row':(column('column')-0.5):(column('column')+0.5):(column('row')-0.5):(column('row')+0.5):(log10(column('share_of_best') + 1e-3)) with boxxyerror palette, \
       csv using (column('column')):(column('row')-0.25):(long_as(column('largest_stable_fs'))) with labels font ',11' noenhanced, \
       csv using (column('column')):(column('row')+0.17):(wrapped(strcol('fails_as'))) with labels font ',7' noenhanced
}
