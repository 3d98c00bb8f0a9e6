"""Report sections: the beam models beside the 3-D FE model, one table per response."""

import numpy as np
import xarray as xr

from impactlab.fem3d.figures import witness
from impactlab.fem3d.wing import UNLIKE
from impactlab.figures import labels
from impactlab.figures.access import responses, usable
from impactlab.figures.labels import Display, display
from impactlab.report.page import Cell, Section, Table

_LEAD = (
    "Each model on its finest grid, with its numerical uncertainty (± of the value itself; none "
    "where a finer grid changes nothing), and its difference from the 3-D finite-element model."
)
_PARTS = (
    "The answer of the paper's beam is turned into that of the 3-D FE model one effect after the "
    "other: (1 + shear)(1 + elasticity)(1 + law) = 1 + all."
)


def sections(runs: xr.Dataset, analysis: xr.Dataset) -> list[Section]:
    """Return the sections of a study with 3-D runs beside others, else none."""
    parts = []
    if witness.differ(runs):
        names = [name for name in responses(runs) if name != "energy_error"]
        tables = [_table(runs, analysis, name) for name in names]
        title = "Model by model"
        parts.append(Section("witness", title, _LEAD, tables=tables, figures=["witness"]))
    if witness.separable(runs):
        title = "Where the difference comes from"
        tables = [_effects(runs, analysis)]
        parts.append(Section("parts", title, _PARTS, tables=tables, figures=["witness_parts"]))
    return parts


def _table(runs: xr.Dataset, analysis: xr.Dataset, name: str) -> Table:
    """Return one row per velocity and one column per model, the 3-D FE model first."""
    models = witness.models(runs)
    unit = display(usable(runs, name))
    sides = [witness.side(runs, analysis, name, model) for model in models]
    rows = []
    for position, speed in enumerate(runs["velocity"].values):
        cells = [_cell(unit, side, sides[0], position, name not in UNLIKE) for side in sides]
        rows.append([Cell(f"{labels.number(float(speed))} m/s", "number"), *cells])
    caption = labels.axis(labels.response(name), unit.symbol)
    if name in UNLIKE:
        caption = f"{caption}: not compared, {UNLIKE[name]}"
    return Table(caption, ["Impact velocity", *map(labels.beam_model, models)], rows)


def _cell(
    unit: Display, side: witness.Side, against: witness.Side, position: int, alike: bool
) -> Cell:
    value = float(side.value[position])
    if not np.isfinite(value):
        return Cell("missing", "warning")
    text = labels.number(float(unit(value)))
    width = float(side.uncertainty[position])
    if value and not width <= 1e-8 * abs(value):  # more than round-off
        text = f"{text} ± {_bound(100.0 * width / abs(value))}"
    gap = float(witness.difference([side], [against]).value[position])
    shown = alike and side is not against and np.isfinite(gap)
    detail = f"{labels.signed(gap)} against the 3-D FE model" if shown else ""
    return Cell(text, "number", detail)


def _effects(runs: xr.Dataset, analysis: xr.Dataset) -> Table:
    """Return one row per effect and one column per response."""
    effects = {name: witness.effects(runs, analysis, name) for name in witness.NAMES}
    rows = []
    for key, text in witness.EFFECTS.items():
        cells = [Cell(labels.sentence(text))]
        for side in (effects[name][key] for name in witness.NAMES):
            value, width = float(side.value), float(side.uncertainty)
            cell = Cell(f"{labels.signed(value)} ± {_bound(100.0 * width)}", "number")
            cells.append(cell if np.isfinite(value) else Cell("missing", "warning"))
        rows.append(cells)
    head = ["Effect", *(labels.title(name) for name in witness.NAMES)]
    return Table("Change of the answer of the paper's beam by each effect", head, rows)


def _bound(percent: float) -> str:
    return f"{labels.number(percent, 2)} %" if np.isfinite(percent) else "?"
