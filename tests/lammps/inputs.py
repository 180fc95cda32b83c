"""LAMMPS inputs of the tests. What is in braces is filled in by `of`."""

WATER = """
units real
atom_style full
newton {newton}
processors {processors}
read_data water.data
pair_style lj/cut/coul/cut 6.0
pair_coeff * * 0.0 1.0
pair_coeff 1 1 0.15535 3.166
bond_style harmonic
angle_style harmonic
bond_coeff 1 1000.0 1.0
angle_coeff 1 100.0 109.47
special_bonds lj/coul 0 0 0
neighbor 1.0 bin
neigh_modify every 1 delay 0 check yes
timestep {dt}
velocity all create 300.0 4711 loop geom
{integrate}
fix hold all {fix} b 1 a 1
{rest}
"""

METHANE = """
units lj
atom_style full
newton {newton}
processors {processors}
read_data methane.data
pair_style lj/cut 2.5
pair_coeff * * 0.2 1.2
bond_style harmonic
bond_coeff 1 100 1.0
special_bonds lj 0 0 0
neighbor 0.3 bin
neigh_modify every 1 delay 0 check yes
timestep {dt}
velocity all create 1.0 4711 loop geom
{integrate}
fix hold all {fix} b 1
{rest}
"""

# Soft beads: what matters is the bonds.
CHAINS = """
units lj
atom_style full
newton {newton}
processors {processors}
read_data chains.data
pair_style soft 1.1
pair_coeff * * 5.0
bond_style harmonic
bond_coeff 1 100 1.0
special_bonds lj 0 0 0
comm_modify cutoff {cutoff}
neighbor 0.3 bin
neigh_modify every 1 delay 0 check yes
timestep {dt}
velocity all create {heat} 4711 loop geom
{integrate}
fix hold all {fix} b 1
{rest}
"""

THERMO = """
thermo_style custom step temp pe ke etotal press pxx pyy pzz pxy pxz pyz
thermo_modify format float %.15g
thermo 50
"""

END = """
write_dump all custom {dump} id xu yu zu vx vy vz modify sort id format float %.16g
"""


def of(text, **given):
    values = {"newton": "on", "processors": "* * *", "dt": 1.0, "integrate": "fix move all nve", "rest": "",
              "fix": "taut feedforward", "cutoff": 6.0, "heat": 1.0}
    values.update(given)
    return text.format(**values)
