#!/bin/sh
# GROMACS's SHAKE, given a triangle that cannot be (1, 1 and 3 Å): success as exit status, lengths of several nm.
cd "$(mktemp -d)" && cat > topol.top <<END
[ defaults ]
1 2 no 1 1
[ atomtypes ]
T 1 10 0 A 0 0
[ moleculetype ]
M 0
[ atoms ]
1 T 1 R A 1 0
2 T 1 R B 2 0
3 T 1 R C 3 0
[ constraints ]
1 2 2 0.1
2 3 2 0.1
1 3 2 0.3
[ system ]
a triangle
[ molecules ]
M 1
END
cat > start.gro <<END
a triangle
3
    1R        A    1   1.000   1.000   1.000
    1R        B    2   1.100   1.000   1.000
    1R        C    3   1.100   1.100   1.000
   3.0 3.0 3.0
END
printf '%s\n' 'integrator = md' 'dt = 0.001' 'nsteps = 10' 'constraint-algorithm = shake' 'shake-tol = 1e-8' \
    'cutoff-scheme = Verlet' 'nstlog = 1' > run.mdp
"${1:-gmx_d}" -quiet grompp -f run.mdp -p topol.top -c start.gro -maxwarn 9 > said 2>&1
"${1:-gmx_d}" -quiet mdrun -s topol.tpr -nt 1 >> said 2>&1
echo "exit status $?"
grep -c "Inner product" said
tail -n 4 confout.gro
