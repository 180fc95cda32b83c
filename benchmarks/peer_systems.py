"""Describes the systems of whole-step comparisons, as taut starts them, for other programs to run."""
import dataclasses
import pathlib
import re
import subprocess
import tempfile
import tomllib


@dataclasses.dataclass
class Molecules:
    name: str  # as step_bench calls it
    count: int
    atoms: list  # of one molecule: (name, mass [u], charge [e], sigma [nm], epsilon [kJ/mol])
    bonds: list  # of one molecule: (i, j, length [nm])
    cutoff: float  # [nm]
    switch: float  # of Lennard-Jones, from here on [nm]; 0: none
    dt_fs: float
    mesh: tuple = ()  # PME's points along each edge; none: reaction field
    shifted: bool = False  # Lennard-Jones is zero at the cutoff
    excluded: int = 1  # bonds apart, up to which chains have no pair forces
    angle: tuple = ()  # of every three in a row: (degrees, k [kJ/mol/rad^2])
    torsion: tuple = ()  # of every four: Ryckaert and Bellemans's coefficients [kJ/mol]
    integrator: str = "md"  # GROMACS's
    coupling: str = ""  # lines of GROMACS's .mdp: thermostat and barostat
    x: list = dataclasses.field(default_factory=list)  # [nm]
    v: list = dataclasses.field(default_factory=list)  # [nm/ps]
    box: list = dataclasses.field(default_factory=list)  # [nm]

    first_steps = 200  # of the run that tells how long one takes

    @property
    def water(self):
        return len(self.bonds) == 3


@dataclasses.dataclass
class Prepared:
    """A system in a folder that real_systems.py wrote. All programs take PME to 0.9 nm, 1e-5 there, of order 4."""
    name: str
    folder: pathlib.Path
    cutoff = 0.9  # [nm]
    switch = 0
    dt_fs = 2
    alpha = 3.4705  # [1/nm]: erfc(alpha cutoff) = 1e-5
    first_steps = 20
    coupling = ""  # lines of GROMACS's .mdp

    def file(self, suffix):
        return self.folder / f"{self.name}.{suffix}"

    @property
    def mesh(self):
        """Returns the least even numbers of points, with no prime factor over 7, that are at most 0.12 nm apart."""
        smooth = sorted(2**a * 3**b * 5**c * 7**d for a in range(1, 9) for b in range(5) for c in range(3) for d in range(2))
        edges = map(float, self.file("gro").read_text().splitlines()[-1].split())
        return tuple(next(n for n in smooth if n >= edge / 0.12) for edge in edges)


def start_of(taut, molecules, arguments):
    """Fills in positions, velocities and box from `taut run ARGUMENTS`."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([taut, "run", *arguments, "--out", folder], check=True, capture_output=True)
        start = tomllib.loads((pathlib.Path(folder) / "final.start.toml").read_text())
    molecules.box = start["box_nm"]
    molecules.x = [row[:3] for row in start["atoms"]]
    molecules.v = [row[3:] for row in start["atoms"]]
    return molecules


def water(taut, count):
    """TIP3P, reaction field: systems/water.toml."""
    oh, hh = 0.09572, 0.15139
    molecules = Molecules(f"water{count}", count,
                          [("O", 15.99943, -0.834, 0.315061, 0.6364)] + [(h, 1.007947, 0.417, 0, 0) for h in ("H1", "H2")],
                          [(0, 1, oh), (0, 2, oh), (1, 2, hh)], 0.9, 0, 2)
    return start_of(taut, molecules, ["water", "--set", f"build.molecules={count}", "--steps", "100"])


def pme(taut, count):
    """The same with PME, 1e-5 at the cutoff, order 4: step_bench's."""
    molecules = water(taut, count)
    return dataclasses.replace(molecules, name=f"pme{count}", mesh=(round(16 / 6 * count ** (1 / 3)),) * 3)


def chains(taut, name, count=100):
    """Chains of 20 Lennard-Jones beads: systems/chain.toml."""
    molecules = Molecules(name, count, [(f"B{b}", 14.0, 0, 0.39, 2.479) for b in range(20)],
                          [(b, b + 1, 0.3783) for b in range(19)], 0.975, 0.85, 5)
    return start_of(taut, molecules, ["chain", "--set", f"build.chains={count}", "--steps", "100"])


def melt(taut, name, count=20):
    """Kremer-Grest chains of 50, rigid bonds, beads that only repel: systems/melt.toml."""
    molecules = Molecules(name, count, [(f"B{b}", 1.0, 0, 1.0, 1.0) for b in range(50)],
                          [(b, b + 1, 0.97) for b in range(49)], 2 ** (1 / 6), 0, 5, shifted=True)
    return start_of(taut, molecules, ["melt", "--set", f"build.chains={count}", "--steps", "100"])


def decane(taut, name, count=128):
    """n-Decane, TraPPE-UA (doi:10.1021/jp972543+), whose energies are in kelvin: systems/decane.toml."""
    kelvin = 8.31446261815324e-3
    end, middle = (15.035, 0, 0.375, 98 * kelvin), (14.027, 0, 0.395, 46 * kelvin)
    c1, c2, c3 = 355.03 * kelvin, -68.19 * kelvin, 791.32 * kelvin
    molecules = Molecules(name, count, [(f"C{c}", *(end if c in (0, 9) else middle)) for c in range(10)],
                          [(c, c + 1, 0.154) for c in range(9)], 1.4, 0, 2, excluded=3, angle=(114, 62500 * kelvin),
                          torsion=(c1 + 2 * c2 + c3, 3 * c3 - c1, -2 * c2, -4 * c3, 0, 0))
    return start_of(taut, molecules, ["decane", "--set", f"place.0.count={count}", "--steps", "100"])


def make(taut, names):
    """What GROMACS and LAMMPS are given; the dipeptide goes to OpenMM alone. A polymer's number is of its atoms."""
    polymers = {"chain": (chains, 20), "melt": (melt, 50), "decane": (decane, 10)}

    def system(name):
        kind, number = re.fullmatch(r"([a-z]+)(\d*)", name).groups()
        if kind in polymers:
            build, length = polymers[kind]
            return build(taut, name, *([int(number) // length] if number else []))
        return {"pme": pme, "water": water}[kind](taut, int(number))

    return [system(name) for name in names if name != "dipeptide"]
