# Draws plane.svg and plane.png from plane.csv: `gnuplot plane.gp` in this folder.
csv = 'plane.csv'
set encoding utf8
do for [kind in 'svg png'] {
  reset
  set datafile separator ','
  set datafile columnheaders
  if (kind eq 'svg') {
    set terminal svg size 800,600 background 'white' font 'Helvetica,12'
  } else {
    set terminal pngcairo size 800,600 background 'white' font 'Helvetica,11'
  }
  set output 'plane.'.kind
  set grid lc rgb '#dddddd' lt 1
  set border lw 0.8
  set tics nomirror
  set multiplot title 'freely_jointed: Baumgarte at 10 fs over the plane of its gains' noenhanced
  set logscale x
  set xrange [0.00749894:2.37367]
  set yrange [0.1:2.3]
  set xtics ('0.01' 0.01, '0.1' 0.1, '1' 1)
  set ytics 0.5
  set style fill solid noborder
  half = 0.1
  wide = 1.33352
  unset key
  do for [row = 0:1] {
    do for [n = 1:3] {
      damping = word('centred implicit lagged', n)
      set lmargin screen 0.08 + 0.265 * (n - 1)
      set rmargin screen 0.08 + 0.265 * (n - 1) + 0.25
      set tmargin screen 0.88 - 0.45 * row
      set bmargin screen 0.54 - 0.45 * row
      if (n == 1) { set ylabel 'βh' offset 1; set format y '%g' } else { unset ylabel; set format y '' }
      if (row == 1) { set xlabel 'αh' offset 0,0.6 } else { unset xlabel }
      if (n == 3) { set colorbox user origin 0.88, 0.54 - 0.45 * row size 0.02, 0.34 } else { unset colorbox }
      set title damping.' damping' offset 0,-0.7
      if (row == 0) {
        set palette defined (0 '#222255', 0.5 '#7788bb', 1 '#ffffcc')
        set logscale cb
        set format cb '%g'
        set cbrange [1:2000]
        set cblabel 'steps survived' offset 1
        plot csv using (strcol('damping') eq damping ? column('alpha_h') : 1/0):'beta_h':(column('alpha_h')/wide):(column('alpha_h')*wide):(column('beta_h')-half):(column('beta_h')+half):(column('steps_survived') > 1 ? column('steps_survived') : 1) with boxxyerror palette, \
             'limits.csv' using (strcol('damping') eq damping ? column('alpha_h') : 1/0):'limit_beta_h' with lines lc rgb 'black' lw 3 dt 2
      } else {
        set palette defined (0 '#ffffcc', 0.5 '#dd7733', 1 '#441122')
        set logscale cb
        set format cb '10^{%L}'
        set autoscale cb
        set cbrange [1e-06:10]
        set cblabel '|drift| [kJ/mol/ns/dof]' offset 1
        plot csv using (strcol('damping') eq damping && column('failed') == 0 ? column('alpha_h') : 1/0):'beta_h':(column('alpha_h')/wide):(column('alpha_h')*wide):(column('beta_h')-half):(column('beta_h')+half):(abs(column('drift_kj_mol_ns_dof'))) with boxxyerror palette, \
             csv using (strcol('damping') eq damping && column('failed') == 1 ? column('alpha_h') : 1/0):'beta_h' with points pt 2 ps 0.8 lc rgb '#555555', \
             'limits.csv' using (strcol('damping') eq damping ? column('alpha_h') : 1/0):'limit_beta_h' with lines lc rgb 'black' lw 3 dt 2
      }
    }
  }
  unset multiplot
}
