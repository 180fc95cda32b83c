# What the pictures of a study share. A picture's script says its name, loads this, counts its curves with
# `stats`, and is drawn twice: do for [kind in 'svg png'] { eval page(kind, width, height); ... }
csv = name.'.csv'
set encoding utf8
set datafile columnheaders
set datafile commentschars ''

title = name
set datafile separator tab
stats 'titles.tsv' using (strcol('picture') eq name ? (title = strcol('title'), 1) : 1) nooutput
set datafile separator ','

page(kind, width, height) = sprintf( \
  "reset; set datafile separator ','; set datafile columnheaders; set datafile commentschars ''; set terminal %s size %d,%d background 'white' font 'Helvetica,%d'; set output '%s.%s'; set grid lc rgb '#dddddd' lt 1; set border lw 0.8; set tics nomirror", \
  kind eq 'svg' ? 'svg' : 'pngcairo', width, height, kind eq 'svg' ? 12 : 11, name, kind)

# Okabe and Ito's colours, which the colour-blind tell apart too; marks for black and white.
own_colour(method) = \
  method eq 'baumgarte'   ? 0xD55E00 : \
  method eq 'feedforward' ? 0x000000 : \
  method eq 'shake'       ? 0x56B4E9 : \
  method eq 'rattle'      ? 0x0072B2 : \
  method eq 'newton'      ? 0x009E73 : \
  method eq 'mshake'      ? 0x9ACD32 : \
  method eq 'lincs'       ? 0xCC79A7 : \
  method eq 'settle'      ? 0xE69F00 : \
  method eq 'penalty'     ? 0x8C564B : \
  method eq 'none'        ? 0x999999 : 0x777777
own_mark(method) = \
  method eq 'baumgarte'   ? 7 : \
  method eq 'feedforward' ? 5 : \
  method eq 'shake'       ? 8 : \
  method eq 'rattle'      ? 9 : \
  method eq 'newton'      ? 13 : \
  method eq 'mshake'      ? 10 : \
  method eq 'lincs'       ? 12 : \
  method eq 'settle'      ? 11 : \
  method eq 'penalty'     ? 4 : \
  method eq 'none'        ? 6 : 2

# Where curves are no methods.
hues = '0x0072B2 0xD55E00 0x009E73 0xCC79A7 0xE69F00 0x56B4E9 0x000000 0x8C564B'
hue(k) = int(word(hues, (k - 1) % 8 + 1))

# The curves of a table in their order, each once: add_curve() is called for every row that is drawn. A method's
# further curves are numbered, from 0.
array curve[1000]
array method[1000]
array number[1000]
curves = 0
is_known(name) = sum [k=1:curves] (curve[k] eq name)
add_curve(name, of) = is_known(name) ? 0 : \
  (curves = curves + 1, number[curves] = sum [k=1:curves-1] (method[k] eq of), curve[curves] = name, method[curves] = of, 1)

is_number(x) = x == x
colour(k) = own_colour(method[k])
mark(k) = own_mark(method[k])
dash(k) = number[k] == 0 ? 1 : number[k] + 2
# Where a method has many curves: other shades and other marks.
mixed(a, b, share) = int(a + (b - a) * share)
blend(rgb, to, share) = \
  65536 * mixed(rgb / 65536, to, share) + 256 * mixed(rgb / 256 % 256, to, share) + mixed(rgb % 256, to, share)
shade(k) = number[k] == 0 ? colour(k) : blend(colour(k), number[k] % 2 ? 0 : 255, 0.16 + 0.1 * number[k])
sign(k) = number[k] == 0 ? mark(k) : word('6 2 4 1 12 3 8', number[k]) + 0

# Nothing got through: there is nothing to draw.
expect_curves = "if (curves == 0) { exit status 4 }"

# |drift| with its interval a to b. Where that holds zero the drift is no more than its upper end: drawn there, with
# an arrow to the left instead of a bar.
has_zero(a, b) = a*b <= 0
low(a, b) = abs(a) < abs(b) ? abs(a) : abs(b)
high(a, b) = abs(a) > abs(b) ? abs(a) : abs(b)
drift_at(d, a, b) = has_zero(a, b) ? high(a, b) : abs(d)
at_drift = 'drift_at(column("drift_kj_mol_ns_dof"), column("drift_low"), column("drift_high"))'
only_if(is_so, value) = is_so ? value : 1/0
arrow_share = 0.45
drift_label = '|energy drift| [kJ/mol/ns/degree of freedom], 95 % interval; arrows: zero is inside, at most that'
cost_label = 'constraint time a bond and step [ns]'
