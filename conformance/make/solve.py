"""The exact motion of a case's system, its tensions and its virial, by an independent solver.

A system with bonds obeys M a = F + Jᵀ λ, J the gradients of ½(|r|² − d²). Differentiating the bonds twice gives
J a = −|ṙ|², so (J M⁻¹ Jᵀ) λ = −|ṙ|² − J M⁻¹ F: a system of index 1 (Hairer & Wanner, Solving Ordinary Differential
Equations II, VII.1). It is integrated by DOP853 to a relative 1e-13, and projections on the way take away what rounding
leaves of the bonds. Redundant bonds share the load with the least sum of squares.

`verlet` is plain velocity Verlet with bonds (RATTLE) solved to rounding. It gives no right value: only the size of the
error that a scheme of second order makes at a step, from which tolerances come.
"""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any, Dict, List, Tuple

import numpy as np
from scipy.integrate import solve_ivp

COULOMB = 138.935456  # kJ/mol nm, of elementary charges
BAR = 16.605390671738466  # bar in 1 kJ/mol/nm³
BOLTZMANN = 0.00831446261815324  # kJ/mol/K
CASES = Path(__file__).resolve().parent.parent / "cases"

Case = Dict[str, Any]


def angle_gradient(a: np.ndarray, b: np.ndarray) -> Tuple[float, np.ndarray, np.ndarray]:
    """The angle between two vectors and its gradients with respect to them."""
    la, lb = np.linalg.norm(a), np.linalg.norm(b)
    cosine = a @ b / la / lb
    sine = np.linalg.norm(np.cross(a, b)) / la / lb
    return math.atan2(sine, cosine), -(b / lb - cosine * a / la) / la / sine, -(a / la - cosine * b / lb) / lb / sine


def torsion_gradient(x: np.ndarray) -> Tuple[float, np.ndarray]:
    """The torsion of four atoms and its gradient (Blondel & Karplus 1996)."""
    f, g, h = x[0] - x[1], x[1] - x[2], x[3] - x[2]
    a, b, length = np.cross(f, g), np.cross(h, g), np.linalg.norm(g)
    phi = math.atan2(np.cross(b, a) @ g / length, a @ b)
    first, last = -length / (a @ a) * a, length / (b @ b) * b
    middle = f @ g / (a @ a) / length * a - h @ g / (b @ b) / length * b
    return phi, np.array([first, -first + middle, -last - middle, last])


class System:
    """A case's system: J, forces and energy at positions."""
    def __init__(self, system: Dict[str, Any]) -> None:
        self.of = system
        self.mass = np.array(system["masses_u"], dtype=float)
        self.pairs = np.array([bond["atoms"] for bond in system["bonds"]], dtype=int).reshape(-1, 2)
        self.length = np.array([bond["length_nm"] for bond in system["bonds"]], dtype=float)
        self.box = np.array(system.get("box_nm", np.zeros((3, 3))), dtype=float)
        images = np.array([bond.get("image", [0, 0, 0]) for bond in system["bonds"]], dtype=float).reshape(-1, 3)
        self.shift = images @ self.box
        sites = [site["atom"] for site in system.get("virtual_sites", [])]
        self.moving = self.mass > 0
        self.inv = np.where(self.moving, 1 / np.where(self.moving, self.mass, 1), 0)
        assert not self.moving[sites].any()

    def place_sites(self, x: np.ndarray) -> np.ndarray:
        x = x.copy()
        for site in self.of.get("virtual_sites", []):
            x[site["atom"]] = np.array(site["weights"]) @ x[site["of"]]
        return x

    def bond_vectors(self, x: np.ndarray) -> np.ndarray:
        return self.spreads(x) + self.shift

    def spreads(self, v: np.ndarray) -> np.ndarray:
        """The velocity of each bond's second end less that of its first, of sites the mean of their parents'."""
        v = self.place_sites(v)
        return v[self.pairs[:, 1]] - v[self.pairs[:, 0]]

    def jacobian(self, x: np.ndarray) -> np.ndarray:
        rows, r = np.arange(len(self.pairs)), self.bond_vectors(x)
        jacobian = np.zeros((len(rows), len(x), 3))
        jacobian[rows, self.pairs[:, 0]] = -r
        jacobian[rows, self.pairs[:, 1]] = r
        for site in self.of.get("virtual_sites", []):  # their parents bear their bonds
            jacobian[:, site["of"]] += np.array(site["weights"])[:, None] * jacobian[:, [site["atom"]]]
            jacobian[:, site["atom"]] = 0
        return jacobian

    def forces(self, x: np.ndarray) -> Tuple[float, np.ndarray]:
        """Potential energy and forces, those of virtual sites handed to their parents."""
        x = self.place_sites(x)
        energy, force = 0.0, np.zeros_like(x)
        for term in self.of["forces"]:
            energy += getattr(self, "_" + term["kind"])(term, x, force)
        for site in self.of.get("virtual_sites", []):
            for parent, weight in zip(site["of"], site["weights"]):
                force[parent] += weight * force[site["atom"]]
            force[site["atom"]] = 0
        return energy, force

    def _gravity(self, term: Dict[str, Any], x: np.ndarray, force: np.ndarray) -> float:
        weight = self.mass[:, None] * np.array(term["acceleration_nm_per_ps2"])
        force += weight
        return -float((weight * x).sum())

    def _constant_force(self, term: Dict[str, Any], x: np.ndarray, force: np.ndarray) -> float:
        pull = np.array(term["force_kj_per_mol_nm"], dtype=float)
        force[term["atom"]] += pull
        return -float(pull @ x[term["atom"]])

    def _harmonic_position(self, term: Dict[str, Any], x: np.ndarray, force: np.ndarray) -> float:
        off, k = x[term["atom"]] - np.array(term["centre_nm"]), term["k_kj_per_mol_nm2"]
        force[term["atom"]] -= k * off
        return 0.5 * k * float(off @ off)

    def _harmonic_bond(self, term: Dict[str, Any], x: np.ndarray, force: np.ndarray) -> float:
        (i, j), k = term["atoms"], term["k_kj_per_mol_nm2"]
        r = np.linalg.norm(x[j] - x[i])
        pull = k * (r - term["length_nm"]) * (x[j] - x[i]) / r
        force[i] += pull
        force[j] -= pull
        return 0.5 * k * (r - term["length_nm"])**2

    def _harmonic_angle(self, term: Dict[str, Any], x: np.ndarray, force: np.ndarray) -> float:
        (i, j, k), stiffness = term["atoms"], term["k_kj_per_mol_rad2"]
        theta, da, db = angle_gradient(x[i] - x[j], x[k] - x[j])
        slope = stiffness * (theta - term["angle_rad"])
        force[i] -= slope * da
        force[k] -= slope * db
        force[j] += slope * (da + db)
        return 0.5 * stiffness * (theta - term["angle_rad"])**2

    def _periodic_torsion(self, term: Dict[str, Any], x: np.ndarray, force: np.ndarray) -> float:
        n, k, phase = term["periodicity"], term["k_kj_per_mol"], term["phase_rad"]
        phi, gradient = torsion_gradient(x[term["atoms"]])
        force[term["atoms"]] += k * n * math.sin(n * phi - phase) * gradient
        return k * (1 + math.cos(n * phi - phase))

    def _nonbonded(self, term: Dict[str, Any], x: np.ndarray, force: np.ndarray) -> float:
        sigma, epsilon, charge = (term[key] for key in ("sigma_nm", "epsilon_kj_per_mol", "charges_e"))
        excluded, energy = {tuple(sorted(pair)) for pair in term["excluded"]}, 0.0
        cutoff, dielectric = term.get("cutoff_nm"), term.get("solvent_dielectric", 78.3)
        bare = not cutoff  # else OpenMM's reaction field
        k_rf = 0 if bare else (dielectric - 1) / (2 * dielectric + 1) / cutoff**3
        c_rf = 0 if bare else 3 * dielectric / (2 * dielectric + 1) / cutoff
        for i in range(len(x)):
            for j in range(i + 1, len(x)):
                r = x[j] - x[i]
                for row in (2, 1, 0) if cutoff else ():
                    r = r - self.box[row] * round(r[row] / self.box[row, row])
                d = np.linalg.norm(r)
                if (i, j) in excluded or (cutoff and d > cutoff):
                    continue
                six = (0.5 * (sigma[i] + sigma[j]) / d)**6
                four, q = 4 * math.sqrt(epsilon[i] * epsilon[j]), COULOMB * charge[i] * charge[j]
                energy += four * (six * six - six) + q * (1 / d + k_rf * d * d - c_rf)
                push = (four * (12 * six * six - 6 * six) / d + q * (1 / d**2 - 2 * k_rf * d)) * r / d
                force[i] -= push
                force[j] += push
        return energy

    def accelerate(self, x: np.ndarray, v: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """Accelerations and λ."""
        jacobian, (_, force) = self.jacobian(x), self.forces(x)
        w = np.sqrt(self.inv)
        scaled = (jacobian * w[:, None]).reshape(len(jacobian), -1)
        wanted = -(self.spreads(v)**2).sum(1) - scaled @ (force * w[:, None]).ravel()
        pull = np.linalg.lstsq(scaled, wanted, rcond=1e-11)[0] if len(jacobian) else np.zeros(v.size)
        multipliers = np.linalg.lstsq(scaled.T, pull, rcond=1e-11)[0] if len(jacobian) else np.zeros(0)
        return force * self.inv[:, None] + w[:, None] * pull.reshape(v.shape), multipliers

    def tensions(self, x: np.ndarray, v: np.ndarray) -> np.ndarray:
        return -self.accelerate(x, v)[1] * self.length

    def project(self, x: np.ndarray, v: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """Positions and velocities on the bonds, the nearest by mass."""
        x, v, w = x.copy(), v.copy(), np.sqrt(self.inv)[:, None]
        for _ in range(20):
            sigma = 0.5 * ((self.bond_vectors(x)**2).sum(1) - self.length**2)
            x -= self._least(x, sigma) * w
            if not sigma.size or np.abs(sigma).max() < 1e-15:
                break
        v = np.where(self.moving[:, None], v, 0)
        jacobian = self.jacobian(x)
        v -= self._least(x, np.einsum("bai,ai->b", jacobian, v)) * w
        return self.place_sites(x), v

    def _least(self, at: np.ndarray, wanted: np.ndarray) -> np.ndarray:
        scaled = (self.jacobian(at) * np.sqrt(self.inv)[:, None]).reshape(len(wanted), -1)
        if not wanted.size:
            return np.zeros_like(at)
        return np.linalg.lstsq(scaled, wanted, rcond=1e-11)[0].reshape(at.shape)


def move(system: System, x: np.ndarray, v: np.ndarray, time: float, parts: int = 20,
         rtol: float = 1e-13) -> Tuple[np.ndarray, np.ndarray]:
    """The exact motion: positions and velocities after a time."""
    n = x.size

    def slope(_: float, y: np.ndarray) -> np.ndarray:
        at, rate = y[:n].reshape(x.shape), y[n:].reshape(x.shape)
        return np.concatenate([rate.ravel(), system.accelerate(at, rate)[0].ravel()])

    x, v = system.project(x, v)
    for _ in range(parts):
        solved = solve_ivp(slope, (0, time / parts), np.concatenate([x.ravel(), v.ravel()]), "DOP853", rtol=rtol,
                           atol=rtol / 10, t_eval=[time / parts])
        x, v = system.project(solved.y[:n, -1].reshape(x.shape), solved.y[n:, -1].reshape(x.shape))
    return x, v


def verlet(system: System, x: np.ndarray, v: np.ndarray, h: float, steps: int) -> Tuple[np.ndarray, np.ndarray]:
    """RATTLE solved to rounding: what a scheme of second order can be expected to do, no right value."""
    x, v = system.project(x, v)
    inv = system.inv[:, None]
    force = system.forces(x)[1]
    for _ in range(steps):
        v = v + 0.5 * h * force * inv
        old, x = x, x + h * v
        along = (system.jacobian(old) * inv).reshape(len(system.pairs), -1)
        for _ in range(50):
            sigma = 0.5 * ((system.bond_vectors(x)**2).sum(1) - system.length**2)
            if not sigma.size or np.abs(sigma).max() < 1e-15:
                break
            matrix = system.jacobian(x).reshape(len(sigma), -1) @ along.T
            move_by = -(along.T @ np.linalg.lstsq(matrix, sigma, rcond=1e-11)[0]).reshape(x.shape)
            x, v = x + move_by, v + move_by / h
        x = system.place_sites(x)
        force = system.forces(x)[1]
        v = system.project(x, v + 0.5 * h * force * inv)[1]
    return x, v


def constraint_virial(system: System, x: np.ndarray, v: np.ndarray) -> float:
    """Σ r·C over bonds, r with its image: −T d each."""
    return -float(system.tensions(x, v) @ system.length)


def up(value: float) -> float:
    """A number rounded up to one digit."""
    if value <= 0:
        return 0.0
    size = 10.0**math.floor(math.log10(value))
    return float(f"{math.ceil(value / size) * size:.1g}")


def cleaned(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, (list, tuple)):
        return [cleaned(one) for one in value]
    if isinstance(value, dict):
        return {key: cleaned(one) for key, one in value.items()}
    if isinstance(value, float):
        value = float(f"{value:.15g}")
        return int(value) if value == int(value) and abs(value) < 1e6 else value
    return value


def in_lines(value: Any, indent: str = "") -> str:
    """JSON with an entry a line as long as it fits into a line of 120."""
    flat = json.dumps(value, ensure_ascii=False)
    if len(indent) + len(flat) <= 110 or not isinstance(value, (dict, list)):
        return flat
    inner = indent + "  "
    if isinstance(value, dict):
        entries = [f"{inner}{json.dumps(key)}: {in_lines(one, inner)}" for key, one in value.items()]
        return "{\n" + ",\n".join(entries) + f"\n{indent}}}"
    return "[\n" + ",\n".join(inner + in_lines(one, inner) for one in value) + f"\n{indent}]"


def write(group: str, case: Case) -> None:
    folder = CASES / group
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{case['name']}.json").write_text(in_lines(cleaned(case)) + "\n", encoding="utf-8")


def bonds_of(pairs: List[Tuple[int, int]], x: np.ndarray) -> List[Dict[str, Any]]:
    """Bonds as long as the positions have them."""
    return [{"atoms": [i, j], "length_nm": float(np.linalg.norm(x[j] - x[i]))} for i, j in pairs]
