"""taut.measure on series whose numbers are known, and on a run beside `taut measure`."""

import numpy as np
import pytest

import taut
from taut import measure


def ar1(rng, times, rows, *shape):
    """Series of correlation 1/e after rows/times, of variance 1."""
    c = np.exp(-times / rows)
    y = np.empty((rows, *shape))
    y[0] = rng.normal(size=shape)
    noise = np.sqrt(1 - c * c) * rng.normal(size=y.shape)
    for n in range(1, rows):
        y[n] = c * y[n - 1] + noise[n]
    return y


def test_the_mean_of_a_correlated_series_has_its_error():
    rng = np.random.default_rng(1)
    found = [measure.mean(5 + ar1(rng, 100, 2000)) for _ in range(50)]
    assert np.mean([m.value for m in found]) == pytest.approx(5, abs=0.08)
    assert np.mean([m.error for m in found]) == pytest.approx(np.sqrt(2 / 100), rel=0.2)
    assert np.isnan(measure.mean([1, 2]).error)
    y = np.concatenate([np.linspace(20, 0, 300), rng.normal(size=1000)])
    assert 200 < measure.equilibration(y) < 400


def test_a_viscosity_is_that_of_its_stress():
    """⟨P P⟩ = p² e^(−t/τ): η = V p² τ/kT."""
    rng = np.random.default_rng(2)
    rows, interval, tau, volume = 40000, 0.02, 0.2, 8.0
    stress = np.sqrt(2.0) * 1e3 * ar1(rng, rows * interval / tau, rows, 6)  # √2: (xx − yy)/2 then has the same variance
    stress[:, 3:] /= np.sqrt(2)
    found = measure.viscosity(stress, interval_ps=interval, volume_nm3=volume, temperature_k=300)
    expected = volume * 1e-27 * (1e3 * 1e5) ** 2 * tau * 1e-12 / (1.380649e-23 * 300) * 1e3
    assert found.viscosity.value == pytest.approx(expected, abs=4 * found.viscosity.error)
    assert found.viscosity.error < 0.15 * expected
    tensor = np.zeros((rows, 3, 3))
    for k, (a, b) in enumerate([(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]):
        tensor[:, a, b] = tensor[:, b, a] = stress[:, k]
    again = measure.viscosity(tensor, interval_ps=interval, volume_nm3=volume, temperature_k=300)
    assert again.viscosity == found.viscosity and (again.integral == found.integral).all()
    with pytest.raises(taut.InputError, match="no viscosity: .* rows are too few"):
        measure.viscosity(stress[:100], interval_ps=interval, volume_nm3=volume, temperature_k=300)


def test_times_say_how_far_apart_rows_are():
    """Of walks every fourth frame in their second part, of numbers a tenth of the rows."""
    rng = np.random.default_rng(7)
    frames = np.r_[0:300, 300:1500:4]
    walks = np.cumsum(rng.normal(scale=0.1, size=(1500, 200, 3)), axis=0)[frames]
    moved = measure.diffusion(walks, time_ps=0.5 * frames)
    assert moved.diffusion.value == pytest.approx(0.01, abs=4 * moved.diffusion.error)
    assert np.allclose(np.diff(0.5 * frames[moved.used]), 2)

    times = np.r_[np.arange(1, 1000), np.arange(1000, 10000, 90)]
    y = np.where(times < 1000, 5.0, 1.0) + 0.1 * rng.normal(size=len(times))
    assert measure.mean(y, time_ps=times).value == pytest.approx(1.4, abs=0.1)
    assert 900 < measure.equilibration(y, time_ps=times) <= 1010


def test_a_log_has_what_its_viscosity_asks_for():
    sim = taut.Simulation("water", set={"build.molecules": 64, "forcefield.cutoff_nm": 0.6, "forcefield.switch_nm": 0.5,
                                        "run.log_every": 1})
    sim.run(1000)
    log = sim.log
    try:
        measure.viscosity(log.pressure_tensor, time_ps=log["time_ps"], volume_nm3=log["volume_nm3"].mean(),
                          temperature_k=log["temperature_k"].mean())
    except taut.InputError as e:
        assert "grows after" in str(e)  # two ps are too short for a number
    assert np.allclose(log.pressure_tensor[:, :3].mean(axis=1), log["pressure_bar"])


def test_random_walks_diffuse_by_their_steps():
    rng = np.random.default_rng(3)
    walks = np.cumsum(rng.normal(scale=0.1, size=(600, 200, 3)), axis=0)
    found = measure.diffusion(walks, interval_ps=0.5)
    assert found.diffusion.value == pytest.approx(0.01 / (2 * 0.5), abs=4 * found.diffusion.error)
    assert found.exponent == pytest.approx(1, abs=0.1)
    pairs = measure.diffusion(walks, interval_ps=0.5, molecules=np.arange(200) // 2)  # centres of two: half of it
    assert pairs.diffusion.value == pytest.approx(0.005, abs=4 * pairs.diffusion.error)
    # Yeh and Hummer: ξkT/(6πηL)
    assert measure.size_correction(temperature_k=300, viscosity_mpa_s=0.3, edge_nm=2) == pytest.approx(
        2.837297 * 1.380649e-23 * 300 / (6 * np.pi * 0.3e-3 * 2e-9) * 1e18 * 1e-12, rel=1e-6)


def test_means_at_several_steps_are_taken_to_none():
    found = measure.at_zero_step([2, 4, 5], [5, -1, -5.5], [0.1, 0.2, 0.5])
    assert found.value.value == pytest.approx(7) and found.slope.value == pytest.approx(-0.5)
    assert found.degrees_of_freedom == 1 and found.chi_square == pytest.approx(0, abs=1e-12)
    assert measure.at_zero_step([2, 4, 6], [0.16, 2.56, 12.96], [0.1, 0.1, 0.1]).chance < 1e-3


def test_ideal_chains_have_their_size():
    """N bonds b: ⟨R²⟩ = N b², ⟨R_g²⟩ = b² N(N + 2)/(6(N + 1))."""
    rng = np.random.default_rng(4)
    bonds = rng.normal(size=(60, 100, 20, 3))
    bonds /= np.linalg.norm(bonds, axis=-1, keepdims=True)
    beads = np.concatenate([np.zeros((60, 100, 1, 3)), np.cumsum(bonds, axis=2)], axis=2).reshape(60, 2100, 3)
    found = measure.chains(beads, np.arange(2100).reshape(-1, 21), interval_ps=1)
    assert found.end_to_end_squared.value == pytest.approx(20, abs=4 * found.end_to_end_squared.error)
    assert found.gyration_squared.value == pytest.approx(20 * 22 / (6 * 21), abs=4 * found.gyration_squared.error)
    assert found.relaxation_ps.value <= 1  # frames that know nothing of each other
    assert found.correlation[0, 0] == pytest.approx(1)


@pytest.mark.parametrize("call, words", [
    (lambda: measure.mean([]), "series: there are no numbers"),
    (lambda: measure.mean([1, np.nan, 2]), "series: expected finite numbers"),
    (lambda: measure.mean([[1.0]]), r"series: expected an array of shape \(n,\), got \(1, 1\)"),
    (lambda: measure.diffusion(np.zeros((5, 4, 3))), "interval_ps, time_ps: expected one of them"),
    (lambda: measure.mean([1, 2, 3], time_ps=[0, 2, 1]), r"time_ps: expected ascending times, but \[2\] is not later"),
    (lambda: measure.at_zero_step([2, 2], [1, 1], [1, 1]), "two lengths of step"),
    (lambda: measure.at_zero_step([2, 4], [1, 1], [1, 0]), "errors: expected numbers above 0"),
    (lambda: measure.viscosity(np.zeros((5, 4)), interval_ps=1, volume_nm3=1, temperature_k=1), r"shape \(n, 6\)"),
    (lambda: measure.viscosity(np.zeros((5, 6)), interval_ps=0, volume_nm3=1, temperature_k=1), "interval_ps: .* above 0"),
    (lambda: measure.diffusion(np.zeros((5, 4, 3)), interval_ps=1), "5 evenly spaced frames are too few"),
    (lambda: measure.diffusion(np.zeros((5, 4, 3)), interval_ps=1, molecules=[0, 1]), "molecules: expected 4 whole"),
    (lambda: measure.chains(np.zeros((5, 4, 3)), [[0, 9]], interval_ps=1), "from 0 to 3, got"),
])
def test_what_cannot_be_measured_says_why(call, words):
    with pytest.raises(taut.InputError, match=words):
        call()
