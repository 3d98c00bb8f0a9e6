"""A page of sliders: the surrogates of a sample, evaluated in the browser as `predict` does."""

import math
import shlex
from dataclasses import asdict
from decimal import ROUND_CEILING, ROUND_FLOOR, Context
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from impactlab.analysis.surrogate import packed
from impactlab.analysis.surrogate.chaos import orthonormal
from impactlab.analysis.surrogate.from_runs import SurrogateVerdict
from impactlab.analysis.surrogate.stored import IMPRECISE
from impactlab.figures import labels
from impactlab.methods.distributions import distribution_of
from impactlab.model.quantities import PREFIXED, symbol
from impactlab.report.page import described, write_page

_POSITIONS = 200  # positions of a slider, about
_OPENINGS = (
    0.5,
    0.6,
    0.4,
    0.7,
    0.3,
)  # quantiles at which the page may open, the first of them best


def write_explorer(runs: xr.Dataset, analysis: xr.Dataset, report: Path) -> str:
    """Write the page beside a report, and return its name; "" where no surrogate is usable.

    A page that an earlier report left there is then removed. runs, analysis: as of write_report.
    Raises OSError when the page cannot be written.
    """
    path = report.with_name(f"{report.stem}_explorer.html")
    surrogates = packed(runs, analysis)
    codes = {} if surrogates is None else surrogates["verdict"].to_series()
    kinds = list(SurrogateVerdict)
    verdicts = {str(name): kinds[int(code)] for name, code in codes.items()}
    if surrogates is None or not any(verdict.sound for verdict in verdicts.values()):
        path.unlink(missing_ok=True)
        return ""
    write_page(
        "explorer.html.j2",
        path,
        **described(runs),
        report=report.name,
        parameters=[
            _parameter(runs[str(name)], surrogates.sel(parameter=name))
            for name in surrogates["parameter"].values
        ],
        responses=[
            _response(surrogates.sel(response=name), runs[name])
            for name, verdict in verdicts.items()
            if verdict.sound
        ],
        refused=[
            (labels.title(name), verdict.meaning)
            for name, verdict in verdicts.items()
            if not verdict.sound
        ],
        good=SurrogateVerdict.USABLE.meaning,
        imprecise=IMPRECISE,
        surrogate=shlex.quote(_from_root(report.with_name("surrogate.nc"))),
    )
    return path.name


def _from_root(path: Path) -> str:
    """Return a path as commands take it in the project's folder, the working directory."""
    absolute, root = path.resolve(), Path.cwd()
    return str(absolute.relative_to(root) if absolute.is_relative_to(root) else absolute)


def _parameter(column: xr.DataArray, entry: xr.Dataset) -> dict[str, Any]:
    """Return what the page knows of a parameter; its range is in its display unit.

    si: what a value there is multiplied by for the polynomials, which take SI units.
    """
    unit, distribution = labels.display(column), distribution_of(column.attrs)
    kind = orthonormal(distribution)
    lowest, highest = (_short(entry[key].item() * unit.scale) for key in ("lowest", "highest"))
    # the ends of the range in few digits, rounded so that they do not leave it
    digits = 6 if highest - lowest > 1e-3 * max(abs(lowest), abs(highest)) else 12
    lowest = float(Context(digits, ROUND_CEILING).create_decimal(repr(lowest)))
    highest = float(Context(digits, ROUND_FLOOR).create_decimal(repr(highest)))
    positions = _positions(lowest, highest, kind.logarithmic)
    openings = distribution.quantile(np.array(_OPENINGS)) * unit.scale
    return {
        "lowest": lowest,
        "highest": highest,
        "range": f"{lowest:.12g} to {highest:.12g} {unit.symbol}".rstrip(),
        "name": str(column.name),
        "label": labels.sentence(labels.parameter(column)),
        "unit": unit.symbol,
        "si": 1 / unit.scale,
        "polynomials": asdict(kind),
        "logarithmic": kind.logarithmic,
        "values": positions,
        "openings": [min(positions, key=lambda x: abs(x - opening)) for opening in openings],
    }


def _positions(lowest: float, highest: float, logarithmic: bool) -> list[float]:
    """Return the values of a slider, rising: both ends of the range, and round ones between."""
    if logarithmic:
        inner = [float(f"{x:.4g}") for x in np.geomspace(lowest, highest, _POSITIONS)]
    else:
        least = (highest - lowest) / _POSITIONS
        decade = 10.0 ** math.floor(math.log10(least))
        step = next(decade * factor for factor in (1, 2, 5, 10) if decade * factor >= least)
        inner = [k * step for k in range(math.ceil(lowest / step), math.ceil(highest / step))]
    return sorted({lowest, highest, *(_short(x) for x in inner if lowest < x < highest)})


def _short(value: float) -> float:
    """Return a number without the last digits, which changes of unit leave."""
    return float(f"{value:.12g}")


def _response(surrogate: xr.Dataset, values: xr.DataArray) -> dict[str, Any]:
    """Return what the page knows of a response; numbers are in its SI unit.

    terms: of each its coefficient, and the parameters that it has a polynomial in, by position,
    with the degree. lowest, highest: of the runs.
    """
    units, name = str(surrogate["response_units"].item()), str(surrogate["response"].item())
    pairs = zip(
        surrogate["coefficient"].values.tolist(), surrogate["degree"].values.tolist(), strict=True
    )
    terms = [
        [coefficient, [[number, degree] for number, degree in enumerate(degrees) if degree]]
        for coefficient, degrees in pairs
        if coefficient
    ]
    return {
        "name": name,
        "label": labels.title(name),
        "meaning": str(surrogate["response_long_name"].item()),
        "symbol": symbol(units),
        "prefixed": units in PREFIXED,
        "terms": terms,
        "error": float(surrogate["error"]),
        "growth": float(surrogate["error_growth"]),
        "reach": float(surrogate["reach"]),
        "q2": f"{float(surrogate['q2']):.4f}",
        "lowest": float(values.min()),
        "highest": float(values.max()),
    }
