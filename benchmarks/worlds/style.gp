# What the pictures of systems/worlds share: `call 'style.gp' NAME HEIGHT`, beside NAME.csv.
set encoding utf8
set datafile separator ','
set datafile columnheaders
set terminal svg size 760,ARG2 background 'white' font 'Helvetica,13'
set output ARG1.'.svg'
csv = ARG1.'.csv'
set grid lc rgb '#dddddd' lt 1
set border lw 0.8
set tics nomirror
set key noenhanced left top Left reverse samplen 2
# Okabe and Ito's colours, as in studies/pictures/taut.gp.
orange = '#D55E00'; blue = '#0072B2'; sky = '#56B4E9'; green = '#009E73'; grey = '#777777'; black = '#000000'; pink = '#CC79A7'
