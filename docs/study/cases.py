"""What the study runs: systems, methods, steps. study.py runs them, judge.py judges them."""
import csv
import dataclasses
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
DATA = HERE / "data"
STEP_FACTORS = (0.25, 0.5, 1, 1.5, 2, 2.5)
LENNARD_JONES_K = 120.27235504272603  # the temperature 1 kJ/mol

# A method's name in the tables, and its keys. {sweeps:4} stands for what `taut calibrate --sweeps 4` finds.
METHODS = {
    "none": ["name=none"],
    "penalty": ["name=penalty"],
    "baumgarte": ["name=baumgarte"],
    "baumgarte as 4 sweeps": ["name=baumgarte", "gains=rattle", "reduction={sweeps:4}"],
    "baumgarte physical": ["name=baumgarte", "gains=physical"],
    "baumgarte box2d": ["name=baumgarte", "gains=box2d"],
    "baumgarte hoomd": ["name=baumgarte", "gains=hoomd"],
    "baumgarte centred": ["name=baumgarte", "damping=centred"],
    "baumgarte implicit": ["name=baumgarte", "damping=implicit"],
    "feedforward": ["name=feedforward"],  # baumgarte at dead-beat
    "shake 1e-4": ["name=shake", "tolerance=1e-4"],
    "shake": ["name=shake"],
    "rattle": ["name=rattle"],
    "newton": ["name=newton"],
    "mshake": ["name=mshake"],
    "lincs": ["name=lincs"],
    "lincs strict": ["name=lincs", "order=8", "iterations=2"],
    "settle": ["name=settle"],
    "settle and lincs": ["name=settle", "solute=lincs"],  # as GROMACS has it: its waters are SETTLE's
}
SHORT_LIST = ("newton", "baumgarte", "feedforward", "settle and lincs", "lincs strict", "shake 1e-4")  # for large systems
MIDDLE_LIST = (*SHORT_LIST, "settle")
MIXED = ("baumgarte", "feedforward", "newton")  # run in mixed precision, too, at the usual step


@dataclasses.dataclass
class System:
    title: str
    scene: list  # what `taut run` is told
    dt_fs: float  # the usual step
    ps: float  # of a run
    temperature_k: float = 298.15
    thermostat_ps: float = 0.5
    equilibrate_ps: float = 0  # before the first run
    settling_ps: float = 0  # of a run's beginning, left out of drifts and means
    openmm: str = ""  # the name of OpenMM's files, in tests/data or made by make_systems.py
    keys: list = dataclasses.field(default_factory=list)
    steps: tuple = ()  # [fs]; none: the usual one by STEP_FACTORS
    reference_fs: float = 0  # a shorter step, of newton alone
    methods: tuple = tuple(METHODS)
    lacks: tuple = ("settle", "settle and lincs")  # methods that are not for it
    precision: str = "double"
    at_rest: bool = True  # or it moves apart, and has no averages to judge

    @property
    def has_forces(self):
        return self.scene != ["freely_jointed"]

    def settings(self, precision):
        """Keys of the bath and of the forces."""
        of_forces = [f"forcefield.precision={precision}"] if self.has_forces else []
        return [*of_forces, f"run.temperature_k={self.temperature_k}", "run.thermostat=rescaling",
                f"run.thermostat_ps={self.thermostat_ps}"]

    def files(self, work):
        """OpenMM's files: the repository's own, or those in the folder work."""
        own = [ROOT / f"tests/data/{self.openmm}.{kind}.xml.gz" for kind in ("system", "state")]
        return own if own[0].exists() else [Path(work) / f"systems/{self.openmm}.{kind}.xml" for kind in ("system", "state")]

    def cells(self):
        """(method, step, precision) of one seed."""
        for method in self.methods:
            if method in self.lacks:
                continue
            if method == "newton" and self.reference_fs:
                yield method, self.reference_fs, self.precision
            for step in self.steps or [factor * self.dt_fs for factor in STEP_FACTORS]:
                yield method, step, self.precision
        if self.precision == "double" and self.has_forces:
            for method in MIXED:
                yield method, self.dt_fs, "mixed"


def pme_water(title, *keys, **more):
    return System(title, ["water"], 2, 10, keys=["forcefield.coulomb=pme", *keys], lacks=("settle and lincs",),
                  settling_ps=2, **more)


FROM_1_FS = dict(steps=(1, 2, 3, 4, 5), reference_fs=0.5)


def of_openmm(title, files, ps, **more):
    settings = FROM_1_FS | {"dt_fs": 2, "lacks": ("settle",)} | more
    return System(title, [], ps=ps, temperature_k=300, openmm=files, settling_ps=2, **settings)


def large(title, files, **more):
    settings = dict(steps=(2, 3, 4), reference_fs=0.5, methods=SHORT_LIST, precision="mixed")
    return of_openmm(title, files, 6, **(settings | more))


HEAVY = dict(dt_fs=4, steps=(3, 4, 5, 6), reference_fs=1)  # hydrogens of 3 u
SYSTEMS = {
    "chains": System("100 free chains of 20", ["freely_jointed"], 10, 20, LENNARD_JONES_K, 1, 20),
    "melt": System("Kremer–Grest melt, 20 × 50", ["melt"], 5, 20, LENNARD_JONES_K, 1, 10),
    "decane": System("decane, 128 molecules", ["decane"], 2, 10),
    "tip3p": pme_water("TIP3P, 216 waters, PME"),
    "tip4p2005": pme_water("TIP4P/2005, 216 waters, PME", "build.model=tip4p2005", equilibrate_ps=20, methods=MIDDLE_LIST,
                           **FROM_1_FS),
    "dipeptide": of_openmm("alanine dipeptide in water, h-bonds", "ala2-hbonds-rf", 6),
    "dipeptide-all": of_openmm("alanine dipeptide in water, all bonds", "dipeptide-all", 6, methods=MIDDLE_LIST),
    "dna": of_openmm("DNA duplex without water, h-bonds", "dna-hbonds", 10, at_rest=False,
                     lacks=("settle", "settle and lincs")),
    "dna-water": large("DNA duplex in water with ions, h-bonds", "dna-water"),
    "villin": large("villin in water, h-bonds", "villin"),
    "villin-all": large("villin in water, all bonds", "villin-all"),
    "villin-angles": large("villin in water, h-angles", "villin-angles"),
    "villin-3u": large("villin in water, h-bonds, hydrogens of 3 u", "villin-3u", **HEAVY),
    "villin-angles-3u": large("villin in water, h-angles, hydrogens of 3 u", "villin-angles-3u", **HEAVY),
}


def cells(names, seeds):
    """All runs, (system, method, step, seed, precision): after the first seed every cell has one value."""
    for seed in range(1, seeds + 1):
        for name in names:
            for method, step, precision in SYSTEMS[name].cells():
                yield name, method, step, seed, precision


def read_rows(file="runs.csv"):
    path = DATA / file
    if not path.exists():
        return []
    with open(path, newline="") as rows:
        return list(csv.DictReader(rows))


def key_of(row):
    return row["system"], row["method"], float(row["dt_fs"]), int(row["seed"]), row["precision"]
