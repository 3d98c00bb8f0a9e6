"""Repeated strikes in the answer and in a table: what they leave, and when that no longer grows."""

from collections.abc import Callable
from itertools import product

import numpy as np
import xarray as xr

from impactlab.figures import labels
from impactlab.figures.access import design_dims, usable
from impactlab.figures.labels import display
from impactlab.figures.strikes import DENT, longest, strike_series
from impactlab.report.page import Cell, Entry, Row, Section, Table
from impactlab.solver.outputs import NO_GROWTH
from impactlab.types import Floats

_DEFLECTION, _RESTITUTION = "residual_deflection_over_strikes", "restitution_over_strikes"
_MOST_RUNS = 20  # in the table


def entries(runs: xr.Dataset) -> list[Entry]:
    """Return what repeated strikes leave, the most important first; none without them."""
    if DENT not in runs or not np.isfinite(usable(longest(runs), DENT)).any():
        return []
    shown = longest(runs)
    dent, count = usable(shown, DENT), shown.sizes["strike"]
    first, last = _ends(dent)
    ratio = (last / first)[first > 0]
    growth = f"grows to {_span(ratio, '')} times that of the first" if ratio.size else "stays"
    before, after = _ends(usable(shown, _RESTITUTION))
    deflection = usable(shown, _DEFLECTION)
    return [
        (
            "Strikes",
            f"Over {count} strikes the dent {growth} ({_amounts(dent, last)}), and "
            f"{_end_of_growth(shown, 'steady_strike', 'dent and deflection')}",
        ),
        (
            "Shakedown",
            _end_of_growth(shown, "shakedown_strike", "dent and dissipation in the fibres"),
        ),
        (
            "Restitution",
            f"{_span(before, '')} at the first strike, {_span(after, '')} at the last",
        ),
        ("Residual deflection", f"{_amounts(deflection, _ends(deflection)[1])} at last"),
    ]


def _ends(series: xr.DataArray) -> tuple[Floats, Floats]:
    """Return the values of first and last strike, of the runs that have both."""
    first, last = (series.isel(strike=place).values.ravel() for place in (0, -1))
    present = np.isfinite(first) & np.isfinite(last)
    return first[present], last[present]


def _span(values: Floats, unit: str) -> str:
    return labels.span(values, 2) + unit if values.size else "missing"


def _amounts(series: xr.DataArray, values: Floats) -> str:
    unit = display(series)
    return _span(unit(values), f" {unit.symbol}")


def _end_of_growth(runs: xr.Dataset, name: str, what: str) -> str:
    """Return from which strike on something does not grow, or that the last still makes it grow.

    Of the runs that have a last strike; what: the subject, in the plural.
    """
    complete = np.isfinite(usable(runs, DENT).isel(strike=-1).values.ravel())
    strikes = usable(runs, name).values.ravel()[complete]
    reached, count = strikes[np.isfinite(strikes)], strikes.size
    if not reached.size:
        return f"{what} still grow at the last{' in every run' if count > 1 else ''}"
    where = f"in {reached.size} of {count} runs " if reached.size < count else ""
    ends = labels.span(reached, 3).replace(" to ", "–")
    return f"{where}{what} no longer grow from strike {ends} on"


def sections(runs: xr.Dataset, place: Callable[[xr.Dataset, dict[str, int]], str]) -> list[Section]:
    """Return the section on repeated strikes, if there are any.

    place: gives a run in words, by its position on the dimensions of the runs.
    """
    if DENT not in runs:
        return []
    shown = longest(runs)
    dims = design_dims(shown, shown[DENT].dims)
    places = [
        dict(zip(dims, position, strict=True))
        for position in product(*(range(shown.sizes[dim]) for dim in dims))
    ]
    units = {name: display(usable(shown, name)) for name in (DENT, _RESTITUTION, _DEFLECTION)}
    rows: list[Row] = []
    for where in places[:_MOST_RUNS]:
        run, cells = shown.isel(where), list[Cell]()
        for name, ends in ((DENT, (0, -1)), (_RESTITUTION, (0, -1)), (_DEFLECTION, (-1,))):
            values = units[name](usable(run, name))
            cells += [_cell(float(values[end])) for end in ends]
        for name in ("steady_strike", "shakedown_strike"):
            strike = float(usable(run, name))
            cells.append(_cell(strike) if np.isfinite(strike) else Cell("not reached", "warning"))
        rows.append([place(shown, where), *cells])
    length = units[DENT].symbol, units[_DEFLECTION].symbol
    head = [
        "Run",
        f"First dent ({length[0]})",
        f"Last dent ({length[0]})",
        "First restitution",
        "Last restitution",
        f"Last deflection ({length[1]})",
        "Steady from strike",
        "Shaken down from strike",
    ]
    caption = f"First and last of {shown.sizes['strike']} strikes"
    if len(places) > _MOST_RUNS:
        caption += f" (the first {_MOST_RUNS} of {len(places)} runs)"
    lead = (
        "Dent and deflection are steady from the strike on from which either changes by at most "
        f"{labels.percent(NO_GROWTH)} of itself per strike. The beam is shaken down from the "
        "strike on from which the same holds for the dent and for what the fibres dissipate. "
        "Where dent and deflection are steady without it, fibres yield to and fro."
    )
    figures = [strike_series.name]
    return [
        Section("strikes", "Strikes", lead, tables=[Table(caption, head, rows)], figures=figures)
    ]


def _cell(value: float) -> Cell:
    return Cell(labels.number(value, 3), "number" if np.isfinite(value) else "warning")
