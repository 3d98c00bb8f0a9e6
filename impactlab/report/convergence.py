"""The verdicts of the convergence studies, a row a response."""

from __future__ import annotations

import numpy as np
import xarray as xr

from impactlab.figures.reading import verdicts, words
from impactlab.figures.reading.contents import known, responses
from impactlab.report.table import Cell, Table


def nodes(runs: xr.Dataset, analysis: xr.Dataset) -> Table | None:
    """Verdict, observed order and grid convergence index in nodes; None without the analysis."""
    if "nodes_summary" not in analysis:
        return None
    head = ["Response", "Worst verdict", "Verdicts over the grid", "Observed order", "Largest GCI"]
    rows = [
        [
            *_verdicts(analysis, "nodes", name),
            Cell(_spread(analysis, "nodes_observed_order", name), "number"),
            Cell(_percent(_largest(analysis, "nodes_gci", name)), "number"),
        ]
        for name in responses(runs)
        if known(analysis, name)
    ]
    return Table("Convergence in nodes along the span", head, rows)


def points(runs: xr.Dataset, analysis: xr.Dataset) -> Table | None:
    """Verdict and points needed for 1 % in integration points; None without the analysis."""
    if "points_summary" not in analysis:
        return None
    head = ["Response", "Worst verdict", "Verdicts over the grid", "Points needed for 1 %"]
    rows = [
        [*_verdicts(analysis, "points", name), _needed(analysis, name)]
        for name in responses(runs)
        if known(analysis, name)
    ]
    return Table("Convergence in integration points over the depth", head, rows)


def meanings(analysis: xr.Dataset, axis: str) -> list[tuple[str, str]]:
    """Each verdict that occurs, in words, with what it means; axis: "nodes" or "points"."""
    found: dict[str, str] = {}
    if f"{axis}_summary" in analysis:
        for name in analysis["response"].values:
            verdict = verdicts.verdict(analysis, f"{axis}_summary", str(name))
            if verdict and verdict.meaning:
                found[verdict.words] = verdict.meaning
    return sorted(found.items())


def _verdicts(analysis: xr.Dataset, axis: str, name: str) -> list[Cell]:
    verdict = verdicts.verdict(analysis, f"{axis}_summary", name)
    text = verdict.words if verdict else "not judged"
    kind = "" if verdict and verdict.sound else "warning"
    return [
        Cell(words.sentence(words.response(name))),
        Cell(text, kind),
        Cell(_tally(analysis, axis, name)),
    ]


def _tally(analysis: xr.Dataset, axis: str, name: str) -> str:
    """How often each verdict occurs over the rest of the grid: "converged 22, divergent 2"."""
    if f"{axis}_tally" not in analysis:
        return "–"
    tally = analysis[f"{axis}_tally"].sel(response=name)
    outcomes = tally[f"{axis}_outcome"].values
    pairs = zip(outcomes, tally.values, strict=True)
    return ", ".join(f"{str(flag).replace('_', ' ')} {int(n)}" for flag, n in pairs if n)


def _needed(analysis: xr.Dataset, name: str) -> Cell:
    """The range over the grid; says where not even the second most points stay within 1 %."""
    if "points_needed" not in analysis:
        return Cell("–", "number")
    needed = analysis["points_needed"].sel(response=name).values
    if np.isnan(needed).all():
        return Cell("none below the most", "warning")
    text = f"{np.nanmin(needed):.0f}"
    if np.nanmax(needed) > np.nanmin(needed):
        text += f" to {np.nanmax(needed):.0f}"
    gaps = int(np.isnan(needed).sum())
    return Cell(
        text, "number", f"none below the most at {gaps} of {needed.size} points" if gaps else ""
    )


def _finite(analysis: xr.Dataset, variable: str, name: str) -> np.ndarray:
    if variable not in analysis:
        return np.array([])
    values = analysis[variable].sel(response=name).values
    return np.asarray(values[np.isfinite(values)], dtype=float)


def _spread(analysis: xr.Dataset, variable: str, name: str) -> str:
    values = _finite(analysis, variable, name)
    if not values.size:
        return "–"
    low, high = (words.number(float(end), digits=3) for end in (values.min(), values.max()))
    return low if low == high else f"{low} to {high}"


def _largest(analysis: xr.Dataset, variable: str, name: str) -> float:
    """The largest value; infinite where one is, NaN where none is."""
    if variable not in analysis:
        return float("nan")
    values = np.ravel(analysis[variable].sel(response=name).values)
    values = values[~np.isnan(values)]
    return float(values.max()) if values.size else float("nan")


def _percent(share: float) -> str:
    return "–" if np.isnan(share) else f"{words.number(100 * share, digits=2)} %"
