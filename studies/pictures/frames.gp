# Draws frames.svg and frames.png from frames.csv: `gnuplot frames.gp` in this folder.
name = 'frames'
load 'taut.gp'
stats csv using (add_curve(strcol('frame'), 'frame'), strcol('what') eq 'atom' ? add_curve(strcol('kind'), 'kind') : 0, 0) nooutput
eval expect_curves
# The same scale in both.
least_x = 1e30; most_x = -1e30; least_up = 1e30; most_up = -1e30
see(x, up, r) = (least_x = x - r < least_x ? x - r : least_x, most_x = x + r > most_x ? x + r : most_x, \
  least_up = up - r < least_up ? up - r : least_up, most_up = up + r > most_up ? up + r : most_up, 0)
stats csv using (strcol('what') eq 'atom' ? see(column('x_nm'), column('up_nm'), 0.4*column('size_nm')) \
  : see(column('x_nm'), column('up_nm'), 0) + see(column('to_x_nm'), column('to_up_nm'), 0)) nooutput
frames = sum [k=1:curves] (method[k] eq 'frame')
is_frame(k) = method[k] eq 'frame'
hues = '0x56B4E9 0xD55E00 0x009E73 0xCC79A7 0xE69F00 0x0072B2 0x8C564B 0x777777'
kind_of(text) = sum [k=1:curves] (method[k] eq 'kind' && curve[k] eq text ? number[k] : 0)
hue(text) = int(word(hues, kind_of(text) % 8 + 1))
here(what) = strcol('frame') eq curve[f] && strcol('what') eq what
x_of(what) = here(what) ? column('x_nm') : 1/0

do for [kind in 'svg png'] {
  eval page(kind, 480*frames, 520)
  set multiplot layout 1, frames title title noenhanced
  set size ratio -1
  set xrange [least_x - 0.03*(most_x - least_x):most_x + 0.03*(most_x - least_x)]
  set yrange [least_up - 0.03*(most_up - least_up):most_up + 0.03*(most_up - least_up)]
  set xlabel 'x [nm]'
  set ylabel 'up [nm]'
  unset key
  set style fill solid 0.85 border lc rgb '#444444'
  do for [f=1:curves] {
    if (is_frame(f)) {
      set title curve[f] noenhanced
      plot csv using (x_of('wall')):'up_nm':(column('to_x_nm') - column('x_nm')):(column('to_up_nm') - column('up_nm')) with vectors nohead lc rgb '#D55E00' lw 3, \
           '' using (x_of('box')):'up_nm':(column('to_x_nm') - column('x_nm')):(column('to_up_nm') - column('up_nm')) with vectors nohead lc rgb '#999999' lw 1, \
           '' using (x_of('bond')):'up_nm':(column('to_x_nm') - column('x_nm')):(column('to_up_nm') - column('up_nm')) with vectors nohead lc rgb '#333333' lw 2, \
           '' using (x_of('atom')):'up_nm':(0.3*column('size_nm')):(hue(strcol('kind'))) with circles lc rgb variable
    }
  }
  unset multiplot
}
