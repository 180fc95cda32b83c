"""The pictures that the command and the module share: their size, curves, names, ranges and files."""

import re

import numpy as np
import pytest

import taut
from taut import pictures

pytest.importorskip("matplotlib", reason="needs matplotlib").use("Agg")
METHODS = ["baumgarte", "feedforward", "shake", "rattle", "newton", "mshake", "lincs", "settle"]


def chart(methods):
    """A table as `taut chart` makes it: four settings a method."""
    rows = [(f"{method} (tolerance)", method, 10.0**-k, 10.0**-k * (n + 1), 3 * 10.0**-k * (n + 1), 10.0 + 5 * k + 20 * n)
            for n, method in enumerate(methods) for k in (3, 6, 9, 12)]
    names = ("curve", "method", "value", "rms_rel_bond_error", "max_rel_bond_error", "ns_per_bond_step")
    return {name: np.array(column) for name, column in zip(names, zip(*rows))}


def written(figure):
    """All texts of a figure."""
    figure.draw_without_rendering()
    from matplotlib.text import Text

    return [text for text in figure.findobj(Text) if text.get_text() and text.get_visible()]


@pytest.mark.parametrize("size", [85, 170])
def test_curves_are_few_in_a_panel_and_named_beside_them(size):
    figure = pictures.draw("work", {"work": chart(METHODS)}, size)
    assert figure.get_figwidth() * 25.4 == pytest.approx(size) and figure.get_figheight() * 25.4 <= 230
    assert not any(axis.get_legend() for axis in figure.axes)
    for axis in figure.axes:
        curves = [line for line in axis.lines if line.get_marker() in "osD^v<>PXh"]
        assert 1 <= len(curves) <= 6
        looks = {(line.get_marker(), str(line.get_linestyle()), line.get_fillstyle()) for line in curves}
        assert len(looks) == len(curves), "told apart in grey"
        low, high = axis.get_xlim()
        assert 1e-14 < low < 1e-12 and 1e-3 < high < 1, "the range of the data"
    texts = written(figure)
    assert {f"{method} (tolerance)" for method in METHODS} <= {text.get_text() for text in texts}
    assert {"1e-12", "0.001"} <= {text.get_text() for text in texts}, "the settings at the ends"
    assert all(7 <= text.get_fontsize() <= 9 for text in texts)


def test_names_stand_upon_no_other():
    figure = pictures.draw("order", {"order": {"method": np.repeat(METHODS[:6], 2), "dt_fs": np.tile([1.0, 2.0], 6),
                                               "rms_distance_nm": np.tile([1e-6, 4e-6], 6) * np.repeat(1 + 1e-3 * np.arange(6), 2),
                                               "order": np.full(12, 2.0)}})
    from matplotlib.text import Text

    boxes = [Text.get_window_extent(text) for text in written(figure) if re.fullmatch(r"\w+ 2\.00", text.get_text())]
    assert len(boxes) == 6
    for k, box in enumerate(boxes):
        assert all(box.y0 > other.y1 or box.y1 < other.y0 for other in boxes[:k])
        assert box.x1 < figure.bbox.x1 and box.y0 > 0 and box.y1 < figure.bbox.y1


def test_names_of_curves_that_crowd_find_room():
    curves = [f"baumgarte ({key})" for key in ("tolerance", "extrapolation", "gains", "reduction", "sweeps")]
    rows = [(curve, "baumgarte", 1.0 + k, 2.0**k * 1e-12, 2.0**k * 1e-12, 7.0) for curve in curves for k in range(3)]
    rows.append(("none", "none", 0.0, 1e-3, 1e-3, 900.0))
    table = dict(zip(chart(["newton"]), map(np.array, zip(*rows))))
    figure = pictures.draw("work", {"work": table})
    from matplotlib.text import Text

    boxes = [Text.get_window_extent(text) for text in written(figure) if text.get_text() in curves]
    assert len(boxes) == len(curves)
    for k, box in enumerate(boxes):
        for other in boxes[:k]:
            wide = min(box.x1, other.x1) - max(box.x0, other.x0)
            high = min(box.y1, other.y1) - max(box.y0, other.y0)
            assert wide <= 0 or high < 0.25 * box.height, "letters upon letters"


def test_methods_with_settings_differ_in_the_picture_of_precisions():
    methods = ["shake", "shake:tolerance=1e-4", "shake:tolerance=1e-6"]
    table = {"method": np.repeat(methods, 2), "precision": np.tile(["double", "mixed"], 3), "step_us": np.arange(1.0, 7),
             "drift_kj_mol_ns_dof": np.arange(1.0, 7), "drift_low": np.arange(1.0, 7) - 0.5, "drift_high": np.arange(1.0, 7) + 0.5}
    lines = [line for axis in pictures.draw("precision", {"precision": table}).axes for line in axis.lines
             if line.get_fillstyle() == "full" and line.get_marker() not in ("None", "", "_", "|")]
    assert len({(line.get_color(), line.get_marker()) for line in lines}) == len(methods)


def run_table(y, panel="temperature [K]", curve="each row"):
    n = len(y)
    return {"panel": np.full(n, panel), "curve": np.full(n, curve), "t_ps": np.linspace(0, 10, n), "value": np.asarray(y),
            "running_mean": np.where(np.arange(n) < n / 2, np.nan, np.median(y[n // 2:]))}


def test_a_run_that_broke_does_not_set_the_range():
    y = 300 + np.sin(np.arange(200.0))
    y[-1] = 1e90
    means = {"panel": ["temperature [K]"], "curve": ["each row"], "from_ps": [5.0], "to_ps": [10.0], "value": [300.0],
             "standard_error": [0.25]}
    axis = pictures.draw("run", {"run": run_table(y), "means": means}).axes[0]
    low, high = axis.get_ylim()
    assert 298 < low < 299.1 and 300.9 < high < 302
    assert axis.get_title(loc="left") == "temperature [K]\nmean 300.00 ± 0.25"
    assert any(list(line.get_xdata()) == [5, 10] and list(line.get_ydata()) == [300, 300] for line in axis.lines)
    error = np.full(200, 1e-11)
    error[0] = 1e-16  # exact at the start
    low, high = pictures.draw("run", {"run": run_table(error, "relative bond error (rms)")}).axes[0].get_ylim()
    assert low > 1e-12 and high < 1e-10


def test_a_run_that_broke_beside_openmm_ends_where_it_did():
    t = np.linspace(0, 1, 50)
    broken = np.where(t < 0.5, 1e-4, 1e90)
    names = np.repeat(["openmm rattle", "newton", "baumgarte physical"], 50)
    table = {"run": names, "t_ps": np.tile(t, 3), "apart_nm": np.concatenate([0 * t, 1e-9 + t * 1e-6, broken]),
             "from_fine_run_nm": np.full(150, 1e-5), "energy_kj_mol": np.concatenate([t, t, broken]),
             "max_rel_bond_error": np.concatenate([0 * t + 1e-8, 0 * t + 1e-12, broken])}
    figure = pictures.draw("crosscheck", {"crosscheck": table})
    assert len(figure.axes) == 4 and all(axis.get_ylim()[1] < 1e3 for axis in figure.axes)


def test_many_runs_are_grey_behind_six():
    table = {name: np.concatenate([run_table(300 + k + np.zeros(10), curve=f"r{k}")[name] for k in range(9)])
             for name in run_table(np.zeros(10))}
    figure = pictures.draw("run", {"run": table})
    assert {text.get_text() for text in written(figure)} >= {f"r{k}" for k in range(6)}
    assert not {"r6", "r7", "r8"} & {text.get_text() for text in written(figure)}


def test_files_are_for_print(tmp_path):
    table = chart(["newton", "rattle"])
    table["curve"] = np.array([name.replace("newton", "$x_2^3$") for name in table["curve"]])
    figure = pictures.draw("work", {"work": table}, 85, title="<1 & 2>")
    assert pictures.save(figure, tmp_path / "work", "pdf,svg,png") == ["work.pdf", "work.svg", "work.png"]
    svg = (tmp_path / "work.svg").read_text()
    assert 'width="240.94' in svg and ">$x_2^3$ (tolerance)<" in svg and "&lt;1 &amp; 2&gt;" in svg
    pdf = (tmp_path / "work.pdf").read_bytes()
    assert pdf.startswith(b"%PDF") and b"MediaBox [ 0 0 240.94" in pdf and b"/Type3" not in pdf and b"FontFile2" in pdf
    from PIL import Image

    assert Image.open(tmp_path / "work.png").width == 1003


def test_a_simulations_log_is_drawn_as_the_command_draws_it():
    sim = taut.Simulation("water", set={"build.molecules": 64, "forcefield.cutoff_nm": 0.55, "forcefield.switch_nm": 0.5,
                                        "run.thermostat": "langevin", "run.temperature_k": 300})
    sim.run(60, every=1)
    figure = sim.plot(size=85)
    titles = [axis.get_title(loc="left") for axis in figure.axes]
    assert [title.split("\n")[0] for title in titles] == [
        "potential energy [kJ/mol]", "energy's account [kJ/mol]", "temperature [K]", "pressure [bar]", "relative bond error"]
    assert re.search(r"\nmean \d+(\.\d+)? ± ", titles[2])
    with pytest.raises(ValueError, match="size: 100, expected 85 or 170"):
        sim.plot(size=100)
