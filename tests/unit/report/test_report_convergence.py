"""Answer, captions, panels and tables of a convergence study say the same of every response."""

import re

import numpy as np
import pytest
import xarray as xr
from drawings import panel, words
from made_runs import design_of

from impactlab.analysis.analyse import analyse
from impactlab.figures import labels
from impactlab.figures.catalogue import CATALOGUE
from impactlab.report.answer import entries
from impactlab.report.convergence import convergence
from impactlab.variables import described
from impactlab.verdicts import TOLERANCE

NONE = "on no grid of this study"
AXES = ("nodes", "points")


@pytest.fixture(scope="module")
def study():
    """Responses of every kind, one of them wild on coarse grids alone."""
    design = design_of(
        {
            "velocity": [1.0, 15.0],
            "rule": ["layers", "lobatto"],
            "points": [3, 5, 9, 17],
            "nodes": [51, 101, 201, 401, 801],
        },
        study="convergence",
        method="grid",
        histories=0,
        profiles=0,
    )
    velocity, nodes, points = design["velocity"], design["nodes"], design["points"]
    h, coarse, fast = 50.0 / (nodes - 1.0), points < 9, velocity > 5
    lobatto = design["rule"] == "lobatto"
    turns = xr.DataArray([0.1, -0.1, 0.1, -0.1, 0.1], {"nodes": nodes}, "nodes")
    power = points ** (-2.0 - 2.0 * lobatto)  # layers need more points
    made = {
        "peak_force": 1.0 + 0.01 * h**2 + power,
        # each axis is within 1 %, both together are not
        "time_of_peak_force": 1.0 + 1.64 * h**2 + 0.027 * (points == 9) * lobatto / 12 + power,
        "contact_duration": 1.0 + turns,
        "maximum_indentation": 1.0 / h,
        "contact_dissipation": h**2,
        "impulse": 1.0 + 1e-4 * h**0.3,
        "number_of_contacts": 3.0 + (nodes > 101),
        "peak_plastic_strain": fast * (1.0 + 0.01 * h**2),
        "remote_plastic_strain": fast * (1.0 + 2.0 / points),
        "restitution": 0.5 + 0.0025 * (points < 17),  # 0.5 % to the next fewer: 1.5 % uncertain
        "plastic_zone_length": fast * (1.0 + 0.01 * h**2 + coarse * (turns + 5.0 * h)),
        "plastic_dissipation": (1.0 + 0.01 * h**2).where((nodes < 401) | (nodes > 401) | ~fast),
    }
    shape = xr.zeros_like(velocity * nodes * points * lobatto, float)
    dims = list(shape.dims)
    runs = design.assign({name: (shape + array).transpose(*dims) for name, array in made.items()})
    runs = runs.assign(status=shape.astype(int)).assign_attrs(responses=list(made))
    runs = described(runs)
    return runs, analyse(runs)


def _answers(study):
    """Return by response the grid that the answer names, with what it says against others."""
    headline, lines, _ = entries(*study)
    sentence = re.fullmatch(
        r"With (.*), and on finer grids, the (.*) (?:is|are) within 1 %.*", headline
    )
    assert sentence
    grid, listed = sentence.groups()
    found = dict.fromkeys(re.split(", | and ", listed), f"from {grid}")
    for head, text in (entry for line in lines for entry in line):
        if head == "On no grid of this study":
            listed = re.findall(r"(?:^|, | and )([a-z][a-z ]*?) \(([^()]*)\)", text)
            found |= {name: f"{NONE}: {doubts}" for name, doubts in listed}
        else:
            names = re.split(", | and ", re.sub(r" \([^()]*\)", "", text))
            found |= dict.fromkeys(names, head.removeprefix("Within 1 % "))
    return found


def _captions(study):
    caption = CATALOGUE["nodes_convergence"].caption(*study)
    listed = re.search(r"uncertainty included: (.*?)\. ", caption)
    assert listed
    found = {}
    for group in listed[1].split("; "):
        names, grid = re.split(r" (?=from \d|on no grid)", group)
        found |= dict.fromkeys(re.split(", | and ", names), grid)
    return found


def _warned(study, axis):
    caption = CATALOGUE[f"{axis}_convergence"].caption(*study)
    listed = re.search(r"Not converged on the finest grid: (.*?)\.", caption)
    assert listed
    return set(re.split(", | and |; ", re.sub(r" \([^()]*\)", "", listed[1])))


def _rows(table):
    texts = [[getattr(cell, "text", cell) for cell in row] for row in table.rows]
    return {row[0].lower(): dict(zip(table.head, row, strict=True)) for row in texts}


def _share(text):
    if "⁻" in text:  # a power of ten, far below the tolerance
        return 0.0
    return np.inf if text == "no bound" else float(text.removesuffix(" %").replace(",", "")) / 100


def test_every_part_of_a_report_says_the_same(study):
    runs, _ = study
    grids, *tables = convergence(*study)[0].tables
    judged = dict(zip(AXES, (_rows(table) for table in tables), strict=True))
    answers, captions, grid_rows = _answers(study), _captions(study), _rows(grids)
    figures = {axis: CATALOGUE[f"{axis}_convergence"].plot(*study) for axis in AXES}
    warned = {axis: _warned(study, axis) for axis in AXES}
    names = [labels.response(name) for name in runs.attrs["responses"]]
    assert set(answers) == set(captions) == set(grid_rows) == set(names)
    for name in names:
        row = grid_rows[name]
        here = row["Within 1 % from"]
        grid = NONE if here == "none of this study" else f"from {here}"
        assert captions[name] == grid
        assert answers[name].partition(":")[0] == grid
        sound = []
        for axis in AXES:
            cells = judged[axis][name]
            verdict, share = cells["Verdict"], _share(list(cells.values())[-1])
            written = words(panel(figures[axis], labels.sentence(name)))
            assert verdict in written, (axis, name)
            is_warned = name in warned[axis]
            sound.append(not is_warned)
            if is_warned:
                assert re.search(rf"{verdict} in [a-z ]*{axis}", row["Doubts"]), (axis, name)
            else:
                assert share <= TOLERANCE, (axis, name)
            if axis == "points":  # of the rule that the answer names
                assert (cells["Points needed for 1 %, Gauss-Lobatto"] != "none of this study") == (
                    not is_warned
                )
            assert share <= _share(row["Least error"]) * 1.06  # two digits are printed
        assert (row["Doubts"] == "–") == (grid != NONE)
        if grid != NONE:
            assert all(sound)
            assert _share(row["Error there"]) <= TOLERANCE
        else:
            assert answers[name].endswith(row["Doubts"])
            assert not all(sound) or "add up" in row["Doubts"]


def test_the_study_shows_every_kind_of_verdict(study):
    """Otherwise the test above says little."""
    doubts = " ".join(_answers(study).values())
    for text in ("divergent", "by design", "tends to zero", "undetermined", "add up", "yet"):
        assert text in doubts
    assert _captions(study)["plastic zone length"].startswith("from ")
