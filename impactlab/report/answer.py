"""The answer to a study's question: at most five lines, in numbers."""

from __future__ import annotations

from collections import defaultdict
from itertools import product

import numpy as np
import xarray as xr

from impactlab.analysis.verdicts import TOLERANCE
from impactlab.figures import access, labels, measures
from impactlab.figures.access import design_dims, is_sample, responses, usable
from impactlab.figures.labels import display
from impactlab.figures.measures import MORRIS, RANKED, SOBOL, Family, analysed
from impactlab.model.parameters import ELEMENTS
from impactlab.report.indices import in_units, with_margin
from impactlab.report.sensitivity import share
from impactlab.verification.finding import gravest_first
from impactlab.verification.stored import unpacked

LINES = 5
_MATTERS = 0.01
"""Smallest share of the largest index that is named."""
_ORDERED = {"nodes": "nodes", "courant": "time_step"} | dict.fromkeys(ELEMENTS, "element_size")
"""Refined axes: the prefix of their variables in the analysis."""
_REFINED = _ORDERED | {"points": "points"}
_COSTS = {"nodes": 3, "points": 1, "courant": -1, ELEMENTS[0]: -4, ELEMENTS[1]: 4}
"""Power of each refined axis in the cost of a run; below zero, less is finer."""
_KINDS = ("rule", "scheme")
"""Discretisations side by side: an answer names the one that needs least."""

_NOTHING = 1e-4
"""Share of the largest magnitude below which an end of a range is round-off."""
_MINOR = (
    "time_of_peak_force",
    "number_of_contacts",
    "total_contact_time",
    "permanent_indentation",
    "impulse",
    "rebound_velocity",
    "remote_plastic_strain",
)
"""Responses that long answers leave to the tables."""

Entry = tuple[str, str]
"""What is told of, and what was found."""


def answers(runs: xr.Dataset, analysis: xr.Dataset | None = None) -> list[str]:
    """Return what a study found, in at most five lines: the main finding first.

    runs, analysis: the stored runs.nc and analysis.nc; or findings.nc alone.
    """
    lines = entries(runs, analysis)
    return ["; ".join(": ".join(entry) for entry in line) + "." for line in lines]


def entries(runs: xr.Dataset, analysis: xr.Dataset | None = None) -> list[list[Entry]]:
    """Return the entries of each line of `answers`."""
    if analysis is None:
        found = _verification(runs)
    elif families := [one for one in RANKED if one.given(analysis) and analysed(runs, analysis)]:
        found = _ranking(runs, analysis, families[0])
    elif not is_sample(runs) and any(f"{axis}_summary" in analysis for axis in _REFINED.values()):
        found = _convergence(runs, analysis)
    else:
        found = _ranges(runs, analysis)
    size = -(-len(found) // LINES)  # responses per line
    return [found[at : at + size] for at in range(0, len(found), max(size, 1))]


def _verification(findings: xr.Dataset) -> list[Entry]:
    outcomes = gravest_first(unpacked(findings))
    total = sum(len(outcome.finding.comparisons) for outcome in outcomes)
    bad = [outcome for outcome in outcomes if outcome.verdict != "passed"]
    size = f"{labels.counted(total, 'comparison')} of {labels.counted(len(outcomes), 'check')}"
    if bad or not outcomes:
        failed = sum(len(outcome.failures) for outcome in outcomes)
        found = [("Failed", f"{failed} of {size}; {len(bad)} did not pass")]
    else:
        found = [("Passed", f"all {size} are within their tolerance")]
    closest = sorted(outcomes, key=lambda outcome: -(outcome.worst.ratio if outcome.worst else 0))
    for outcome in (bad or closest)[: LINES - 1]:
        worst, text = outcome.worst, outcome.reason or "it compared nothing"
        if worst and not outcome.reason:
            text = f"largest error {labels.percent(worst.ratio)} of its tolerance"
            text += f", {worst.quantity}, {worst.where}"
        found.append((outcome.title, text))
    return found


def _ranking(runs: xr.Dataset, analysis: xr.Dataset, family: Family) -> list[Entry]:
    """Return one entry per response: the parameters that matter, and whether to trust this."""
    names = [labels.parameter(name) for name in measures.parameters(analysis)]
    shown = analysed(runs, analysis)
    most = max(1, 4 - -(-len(shown) // LINES))  # named per response
    found: list[Entry] = []
    for name in shown:
        index = measures.index(analysis, measures.ranking(family).name, name)
        sizes = np.where(index.significant, np.abs(index.values), 0.0)
        listed: list[str] = []
        for at in np.argsort(-sizes, kind="stable")[:most].tolist():
            value, margin = float(index.values[at]), float(index.margins[at])
            if family is SOBOL:
                text = share(index, at)
            elif family is MORRIS:
                text = in_units(runs[name], value, margin)
            else:
                text = with_margin(value, margin)
            if family is SOBOL and not found and not listed:
                text += " of the variance"
            if sizes[at] > _MATTERS * sizes.max():
                listed.append(f"{names[at]} {text}")
        verdict = access.verdict(analysis, "sensitivity_verdict", name)
        subject = labels.sentence(labels.response(name))
        found.append(
            (
                f"{subject} ({verdict.words})" if verdict else subject,
                ", ".join(listed) or "no parameter stands out from the noise",
            )
        )
    return found


def _ranges(runs: xr.Dataset, analysis: xr.Dataset) -> list[Entry]:
    """Return one entry per parameter that drives responses: the range of each of these."""
    drives: dict[str, list[tuple[float, str]]] = defaultdict(list)
    shown = [name for name in responses(runs) if name != "energy_error"] or responses(runs)
    if len(shown) > 2 * LINES:
        shown = [name for name in shown if name not in _MINOR]
    for name in shown:
        array, unit = usable(runs, name), display(runs[name])
        array = array.where(np.isfinite(array))
        text = f"{labels.response(name)} "
        if array.isnull().all():
            drives["Missing in every run"].append((np.nan, text.strip()))
            continue
        numbers = unit(array.values[np.isfinite(array.values)])
        numbers[np.abs(numbers) < _NOTHING * np.abs(numbers).max()] = 0.0
        text += labels.span(numbers, 3)
        text += f" {unit.symbol}" * bool(unit.symbol)
        if "numerical_uncertainty" in analysis and access.known(analysis, name):
            error = labels.percent(float(analysis["numerical_uncertainty"].sel(response=name)))
            text += f" (numerically ± {error})"
        if gaps := int(array.isnull().sum()):
            text += f" ({gaps} missing)"
        effects = {
            labels.parameter(dim): float(array.mean(set(array.dims) - {dim}).var() / array.var())
            for dim in design_dims(runs, array.dims)
            if array.sizes[dim] > 1 and array.max() > array.min()
        }
        driver = max(effects, key=effects.__getitem__, default="the same in every run")
        if effects and effects[driver] < 0.5:
            driver = "several parameters together"
        drives[driver].append((effects.get(driver, np.nan), text))
    found = []
    for driver, told in sorted(drives.items(), key=lambda item: -len(item[1])):
        shares = np.array([effect for effect, _ in told])
        subject = labels.sentence(driver)
        if np.isfinite(shares).all() and len(design_dims(runs)) > 1:
            subject += f" ({labels.span(100 * shares, 2)} % of the variation)"
        found.append((subject, ", ".join(text for _, text in told)))
    if left := len(responses(runs)) - len(shown):
        found[-1] = (
            found[-1][0],
            f"{found[-1][1]}; {labels.counted(left, 'other response')} below",
        )
    return found


def _convergence(runs: xr.Dataset, analysis: xr.Dataset) -> list[Entry]:
    """Return the coarsest discretisations that keep responses within tolerance.

    A value counts as within where its difference to the finest grid and the uncertainty of that
    grid add up to no more, here and on all finer grids, at each point of the rest of the grid.
    """
    judged = []
    for dim, axis in _REFINED.items():
        if dim in runs.dims:
            runs = runs.sortby(dim, ascending=_COSTS[dim] < 0)  # the finest first
            if f"{axis}_uncertainty" in analysis:
                judged.append(dim)
            else:
                runs = runs.isel({dim: 0})
    kinds = [dim for dim in _KINDS if runs.sizes.get(dim, 1) > 1]
    tried = []
    for kind in product(*(runs[dim].values.tolist() for dim in kinds)):
        here = runs.sel({dim: [value] for dim, value in zip(kinds, kind, strict=True)})
        tried.append((here, *_least(here, analysis, judged)))
    runs, needs, errors = max(tried, key=lambda one: len(one[1]))  # the first of equals
    words = "".join(f", {labels.values(runs[dim], [0])[0]}" for dim in kinds)
    found = []
    for need, names in _grouped(needs):
        grid = zip((runs[dim] for dim in judged), need, strict=True)
        text = labels.listing([_setting(coordinate, at) for coordinate, at in grid])
        told = [f"± {labels.percent(max(float(errors[name][need]) for name in names))}"]
        for axis in (_ORDERED[dim] for dim in judged if dim in _ORDERED):
            orders = _finest(analysis[f"{axis}_observed_order"], runs).sel(response=names).values
            if np.isfinite(orders).any():
                order = labels.span(orders[np.isfinite(orders)], 2)
                told.append(f"observed order {order} in the {axis.replace('_', ' ')}")
        listed = labels.listing([labels.response(name) for name in names])
        head = f"Within {labels.percent(TOLERANCE)} from {text}{words}"
        found.append((head, f"{listed} ({', '.join(told)})"))
    beyond = [
        _doubt(runs, analysis.sel(response=name), float(errors[name].min()), judged)
        for name in errors
        if name not in needs
    ]
    return found + ([("On no grid of this study", labels.listing(beyond))] if beyond else [])


def _finest(array: xr.DataArray, runs: xr.Dataset) -> xr.DataArray:
    """Return a variable of the analysis at the finest grid of the runs, and of their kind."""
    at = [dim for dim in (*_REFINED, *_KINDS) if dim in array.dims]
    return array.sel({dim: runs[dim].values.flat[0] for dim in at}, drop=True)


def _doubt(runs: xr.Dataset, analysis: xr.Dataset, error: float, judged: list[str]) -> str:
    """Return a response without a grid that is fine enough: its least error and its verdicts."""
    said = [f"± {labels.percent(error)}"] if error < 1 else []
    for dim in judged:
        worst = access.occurring(_finest(analysis[f"{_REFINED[dim]}_verdict"], runs))[-1]
        if not worst.sound and worst.words not in said:
            said.append(worst.words)
    return f"{labels.response(str(analysis['response'].item()))} ({', '.join(said)})"


def _grouped(needs: dict[str, tuple[int, ...]]) -> list[tuple[tuple[int, ...], list[str]]]:
    """Return grids and the responses that each is fine enough for, the most responses first."""
    groups: dict[tuple[int, ...], list[str]] = defaultdict(list)
    for name, need in needs.items():
        groups[need].append(name)
    while len(groups) > LINES - 1:  # the two smallest groups share a grid that is fine enough
        one, other = sorted(groups, key=lambda need: len(groups[need]))[:2]
        both = groups.pop(one) + groups.pop(other)
        groups[tuple(map(min, one, other))] += both
    return sorted(groups.items(), key=lambda item: -len(item[1]))


def _setting(coordinate: xr.DataArray, at: int) -> str:
    """Return one value of a refined axis: "201 nodes", "courant 0.2"."""
    if coordinate.name in ("nodes", "points"):
        return labels.value(coordinate, at)
    name = str(coordinate.name).replace("_", " ")
    return f"{name} {labels.values(coordinate, [at])[0]}{labels.unit(coordinate)}"


def _least(
    runs: xr.Dataset, analysis: xr.Dataset, judged: list[str]
) -> tuple[dict[str, tuple[int, ...]], dict[str, xr.DataArray]]:
    """Return the coarsest grid (positions on the judged axes) of each response that has one.

    Beside it, by response, the largest relative error on (*judged axes).
    """
    cost = xr.ones_like(runs[judged[0]], float)
    for dim in judged:
        cost = cost * runs[dim].astype(float) ** _COSTS[dim]
    needs, errors = {}, {}
    for name in analysed(runs, analysis):
        values, finest = usable(runs, name), usable(runs, name).isel(dict.fromkeys(judged, 0))
        error = abs(values - finest) / abs(finest)
        for dim in judged:
            bound = analysis[f"{_REFINED[dim]}_uncertainty"].sel(response=name)
            error = error + _finest(bound, runs)
        same = (values == finest).all(judged)  # as is a plastic strain that is zero everywhere
        error = error.fillna(np.inf).where(~same, 0.0)
        error = error.max([dim for dim in error.dims if dim not in judged])
        within = (error <= TOLERANCE).astype(int)
        for dim in judged:
            within = within.cumprod(dim)
        errors[name] = error.transpose(*judged)
        if within.any():
            best = cost.where(within == 1).transpose(*judged).argmin(...)
            needs[name] = tuple(int(best[dim]) for dim in judged)
    return needs, errors
