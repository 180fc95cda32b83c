# Draws plane.svg and plane.png from plane.csv and limits.csv: `gnuplot plane.gp` in this folder.
# Light is good in all of it, and grey tones keep the order.
name = 'plane'
load 'taut.gp'
stats csv using (column('alpha_h')):(column('beta_h')) name 'gain' nooutput
stats csv using (column('of_steps')) name 'steps' nooutput
next_a = 1e9; next_b = 1e9; least = 1e9; most = 0
after_first(a, b) = (next_a = a > gain_min_x && a < next_a ? a : next_a, next_b = b > gain_min_y && b < next_b ? b : next_b)
drifted(d) = d > 0 ? (least = d < least ? d : least, most = d > most ? d : most) : 0
stats csv using (after_first(column('alpha_h'), column('beta_h')), column('failed') == 0 ? drifted(abs(column('drift_kj_mol_ns_dof'))) : 0) nooutput
newton = 'failed'
said(d) = d == d ? (newton = sprintf('%.2g', d), 0) : 0
stats csv using (said(column('newton_drift'))) nooutput
wide = sqrt(next_a / gain_min_x)
half = (next_b - gain_min_y) / 2
seen = ''
stats csv using (seen = strstrt(seen, strcol('damping')) ? seen : seen.' '.strcol('damping'), 1) nooutput
dampings = ''
do for [damping in 'discrete centred implicit lagged'] { if (strstrt(seen, damping)) { dampings = dampings.' '.damping } }
last = words(dampings)
pitch = 0.8 / last

do for [kind in 'svg png'] {
  eval page(kind, 800, 600)
  set multiplot title title noenhanced
  set logscale x
  set xrange [gain_min_x / wide : gain_max_x * wide]
  set yrange [gain_min_y - half : gain_max_y + half]
  set xtics ('0.01' 0.01, '0.1' 0.1, '1' 1)
  set ytics 0.5
  set style fill solid noborder
  unset key
  do for [row = 0:1] {
    do for [n = 1:last] {
      damping = word(dampings, n)
      set lmargin screen 0.07 + pitch * (n - 1)
      set rmargin screen 0.07 + pitch * n - 0.015
      set tmargin screen 0.88 - 0.45 * row
      set bmargin screen 0.54 - 0.45 * row
      if (n == 1) { set ylabel 'βh' offset 1; set format y '%g' } else { unset ylabel; set format y '' }
      if (row == 1) { set xlabel 'αh' offset 0,0.6 } else { unset xlabel }
      if (n == last) { set colorbox user origin 0.88, 0.54 - 0.45 * row size 0.02, 0.34 } else { unset colorbox }
      set title damping.' damping' offset 0,-0.7
      set logscale cb
      if (row == 1 && n == 1) {
        set label 1 'failed' at screen 0.3, 0.935 offset 1, 0 point pt 2 ps 0.8 lc rgb '#555555'
        set arrow 1 from screen 0.44, 0.935 to screen 0.5, 0.935 nohead lc rgb 'black' lw 3 dt 2
        set label 2 'limit of one bond' at screen 0.51, 0.935
        set label 3 'newton: '.newton at screen 0.99, 0.04 right
      } else { unset label; unset arrow }
      if (row == 0) {
        set palette defined (0 '#222255', 0.5 '#7788bb', 1 '#ffffcc')
        set format cb '%g'
        set cbrange [1:steps_max]
        set cblabel 'steps survived' offset 1
        plot csv using (strcol('damping') eq damping ? column('alpha_h') : 1/0):'beta_h':(column('alpha_h')/wide):(column('alpha_h')*wide):(column('beta_h')-half):(column('beta_h')+half):(column('steps_survived') > 1 ? column('steps_survived') : 1) with boxxyerror palette, \
             'limits.csv' using (strcol('damping') eq damping ? column('alpha_h') : 1/0):'limit_beta_h' with lines lc rgb 'black' lw 3 dt 2
      } else {
        set palette defined (0 '#ffffcc', 0.5 '#dd7733', 1 '#441122')
        set format cb '10^{%L}'
        set autoscale cb
        set cbrange [most > 0 ? 10**floor(log10(least)) : 0.1 : most > 0 ? 10**ceil(log10(most)) : 1]
        set cblabel '|drift| [kJ/mol/ns/dof]' offset 1
        plot csv using (strcol('damping') eq damping && column('failed') == 0 ? column('alpha_h') : 1/0):'beta_h':(column('alpha_h')/wide):(column('alpha_h')*wide):(column('beta_h')-half):(column('beta_h')+half):(abs(column('drift_kj_mol_ns_dof'))) with boxxyerror palette, \
             csv using (strcol('damping') eq damping && column('failed') == 1 ? column('alpha_h') : 1/0):'beta_h' with points pt 2 ps 0.8 lc rgb '#555555', \
             'limits.csv' using (strcol('damping') eq damping ? column('alpha_h') : 1/0):'limit_beta_h' with lines lc rgb 'black' lw 3 dt 2
      }
    }
  }
  unset multiplot
}
