"""The answer to a study's question: at most five lines, in numbers."""

from __future__ import annotations

from collections import defaultdict
from math import isfinite

import numpy as np
import xarray as xr

from impactlab.analysis.analyse import analyse
from impactlab.figures import access, labels, measures
from impactlab.figures.access import design_dims, responses, usable
from impactlab.figures.distributions import spread_evenly
from impactlab.figures.labels import display
from impactlab.figures.measures import MORRIS, SOBOL, Index, analysed
from impactlab.figures.needs import ORDERED, Needs, needed
from impactlab.methods.record import Family
from impactlab.report import measured
from impactlab.report.cautions import beside
from impactlab.report.distribution import limit_entries
from impactlab.report.regimes import jump_entries, regime_entries
from impactlab.report.sensitivity import (
    history_entries,
    in_units,
    share,
    shared,
    uncertainty,
    with_margin,
)
from impactlab.verdicts import TOLERANCE
from impactlab.verification.finding import gravest_first
from impactlab.verification.outcomes import unpacked

LINES = 5
_LIMITS = 2  # lines that limits may take of these
_MATTERS = 0.01  # smallest share of the largest index that is named
_INTERACTS = 0.02  # smallest share of the variance from interactions that is told
_NOTHING = 1e-4  # share of the largest magnitude below which an end of a range is round-off
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
    """Return the findings of a study in at most five lines, the main finding first.

    Parameters
    ----------
    runs : xarray.Dataset
        Runs of a study as in runs.nc, or the findings of a verification as in findings.nc.
    analysis : xarray.Dataset, optional
        Analysis of the runs as in analysis.nc; by default `analyse(runs)`.

    Returns
    -------
    list of str
        Sentences, with units and intervals.

    Examples
    --------
    >>> study = il.Study(
    ...     title="Ishigami", function="ishigami", sampling=il.Sobol(base_samples=256, parameters={
    ...         name: il.Uniform("-3.14", "3.14") for name in ("x1", "x2", "x3")}))
    >>> runs = study.run(workers=1)
    >>> for line in il.answers(runs, il.analyse(runs)):
    ...     print(line)
    Value (usable): x1 ...
    """
    if analysis is None and runs.attrs.get("content") != "findings":
        analysis = analyse(runs)
    lines, _ = entries(runs, analysis)
    sentences = ["; ".join(": ".join(entry) for entry in line) + "." for line in lines]
    if sentences and (correlated := shared(runs)):
        sentences[0] += f" {correlated}"
    return sentences or ["There is no answer in these runs."]


def entries(runs: xr.Dataset, analysis: xr.Dataset | None = None) -> tuple[list[list[Entry]], str]:
    """Return the entries of each line of `answers`, and what their numbers are."""
    if analysis is None:
        return _packed(_verification(runs), LINES), ""
    if (families := measures.families(runs, analysis)) and analysed(runs, analysis):
        findings = _ranking(runs, analysis, families[0])
        kind = families[0].ranked_by(analysis).label
        note = f"{families[0].title}, {kind}, ± the half-width of the"
        note += f" {access.confidence(analysis)} interval. {shared(runs)}".rstrip()
    elif needs := needed(runs, analysis):
        findings = _convergence(needs)
        note = "± the difference to the finest grid and the numerical uncertainty of that grid."
    else:
        findings = _ranges(runs, analysis)
        note = (
            "Variation: the variance over the grid; a parameter explains that of its mean effect."
        )
        if "nodes" in runs.coords and "numerical_uncertainty" not in analysis:
            note += " The numerical uncertainty is not known: impactlab recommend measures it."
    if limits := limit_entries(runs, analysis):
        level, even = access.confidence(analysis), spread_evenly(runs)
        note = f"Above a limit: probability and its {level} interval{even}. {note}"
    first = _packed([*regime_entries(runs), *jump_entries(runs)], 1) + _packed(limits, _LIMITS)
    last = measured.entries(analysis)
    if over := history_entries(analysis):
        note += " Over time: generalised total order, of the variance added up over all times."
    room = LINES - len(first) - bool(last)
    histories = _packed(over, 2 if room >= len(findings) + len(over) else 1)
    lines = [*first, *_packed(findings, room - len(histories)), *histories]
    return [*lines, last] if last else lines, note


def _packed(findings: list[Entry], lines: int) -> list[list[Entry]]:
    size = max(1, -(-len(findings) // lines))  # entries per line
    return [findings[first : first + size] for first in range(0, len(findings), size)]


def _verification(stored: xr.Dataset) -> list[Entry]:
    outcomes = gravest_first(unpacked(stored))
    total = sum(len(outcome.finding.comparisons) for outcome in outcomes)
    bad = [outcome for outcome in outcomes if outcome.verdict != "passed"]
    size = f"{labels.counted(total, 'comparison')} of {labels.counted(len(outcomes), 'check')}"
    findings = [("Passed", f"all {size} are within their tolerance")]
    if bad or not outcomes:
        failed = sum(len(outcome.failures) for outcome in outcomes)
        findings = [("Failed", f"{failed} of {size}; {len(bad)} did not pass")]
    closest = sorted(outcomes, key=lambda outcome: -(outcome.worst.ratio if outcome.worst else 0))
    for outcome in (bad or closest)[: LINES - 1]:
        worst, text = outcome.worst, outcome.reason or "it compared nothing"
        if worst and not outcome.reason:
            many = (
                f"{labels.percent(worst.ratio)} of"
                if isfinite(worst.ratio)
                else "infinitely many times"
            )
            text = f"largest error {many} its tolerance"
            text += f", {worst.quantity}, {worst.where}"
        findings.append((outcome.title, text))
    return findings


def _ranking(runs: xr.Dataset, analysis: xr.Dataset, family: Family) -> list[Entry]:
    """Return one entry per response: the parameters that matter, and whether to trust this."""
    names, shown = measures.parameters(analysis), analysed(runs, analysis)
    most = max(1, 4 - -(-len(shown) // LINES))  # named per response
    measure = family.ranked_by(analysis).name
    findings: list[Entry] = []
    for name in shown:
        index = measures.index(analysis, measure, name)
        sizes = np.where(index.above_noise, np.abs(index.values), 0.0)
        listed: list[str] = []
        for number in np.argsort(-sizes, kind="stable")[:most].tolist():
            share_of = "" if findings or listed else " of the variance"
            text = _written(runs, analysis, family, index, name, number, share_of)
            if not listed:
                text += _of_words(runs, names[number], name)
            if sizes[number] > _MATTERS * sizes.max():
                listed.append(f"{labels.parameter(names[number])} {text}")
        if listed and family.explained in analysis:
            fit = float(analysis[family.explained].sel(response=name))
            listed[-1] += f" (R² of the fit: {labels.number(fit, 2)})"
        verdict = access.verdict(analysis, "sensitivity_verdict", name)
        if verdict and verdict.flag == "several_regimes":
            continue  # the first line is about them
        subject = labels.sentence(labels.response(name))
        none = "no parameter stands out from the noise"
        if not np.isfinite(index.values).any():
            none = "no index is defined"
        summary = ", ".join(listed) or none
        if gaps := int(access.absent(runs, name).sum()):
            summary += f" ({gaps:,} of {labels.counted(access.count(runs), 'run')} missing)"
        findings.append((f"{subject} ({verdict.words})" if verdict else subject, summary))
    return findings


def _of_words(runs: xr.Dataset, parameter: str, response: str) -> str:
    """Return which words give the least and the largest mean response; "" for numbers."""
    listed = labels.words(runs[parameter]) if parameter in runs.coords else []
    if not listed:
        return ""
    means = access.means_by_word(runs, parameter, response).values()
    intervals = [
        (interval, word)
        for word, interval in zip(listed, means, strict=True)
        if interval[0] == interval[0]
    ]
    low, high = (
        f"{in_units(runs[response], *interval)} with {word}"
        for interval, word in (min(intervals), max(intervals))
    )
    return f" (on average {low} to {high})"


def _written(
    runs: xr.Dataset,
    analysis: xr.Dataset,
    family: Family,
    index: Index,
    name: str,
    number: int,
    share_of: str,
) -> str:
    """Return an index with its interval, and of a Sobol index what the parameter does alone.

    share_of: follows a share of the variance, which the first one of an answer names.
    """
    value, margin = float(index.values[number]), float(index.margins[number])
    text = with_margin(value, margin)
    if family is MORRIS:
        text = in_units(runs[name], value, margin)
    elif family is SOBOL:
        text = share(value, margin, float(index.numerical[number])) + share_of
        first = measures.index(analysis, "first_order", name)
        surplus = value - first.values[number]  # none where the first order ranks
        reach = margin + first.margins[number] + index.numerical[number] + first.numerical[number]
        if surplus > max(_INTERACTS, reach):
            text += f", {max(0.0, 100 * first.values[number]):.0f} % alone"
    if index.numerically_lost[number]:
        text += ", which the numerical error may explain"
    return text


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
        text += labels.span(numbers, 3) + labels.unit(runs[name])
        if "numerical_uncertainty" in analysis and access.known(analysis, name):
            error = float(analysis["numerical_uncertainty"].sel(response=name))
            text += f" (numerically {uncertainty(error)})"
        gaps = int(array.isnull().sum())
        doubts = [f"{gaps} missing" if gaps else "", beside(runs, analysis, name)]
        if any(doubts):
            text += f" ({'; '.join(filter(None, doubts))})"
        effects = {
            labels.parameter(dim): float(array.mean(set(array.dims) - {dim}).var() / array.var())
            for dim in design_dims(runs, array.dims)
            if array.sizes[dim] > 1 and array.max() > array.min()
        }
        driver = max(effects, key=effects.__getitem__, default="the same in every run")
        if effects and effects[driver] < 0.5:
            driver = "several parameters together"
        drives[driver].append((effects.get(driver, np.nan), text))
    findings, left = [], len(responses(runs)) - len(shown)
    for driver, texts in sorted(drives.items(), key=lambda item: -len(item[1])):
        shares, subject = np.array([effect for effect, _ in texts]), labels.sentence(driver)
        if (shares >= 0.5).all() and len(design_dims(runs)) > 1:
            subject += f" explains {labels.span(100 * shares, 2)} % of the variation"
        findings.append((subject, ", ".join(text for _, text in texts)))
    if left:
        subject, text = findings.pop()
        findings.append((subject, f"{text}; {labels.counted(left, 'other response')} below"))
    return findings


def _convergence(needs: Needs) -> list[Entry]:
    """Return one entry per grid that keeps responses within tolerance, and those without any."""
    groups: dict[tuple[int, ...], list[str]] = defaultdict(list)
    for name, need in needs.grids.items():
        groups[need].append(name)
    findings = []
    for need, names in sorted(groups.items(), key=lambda item: -len(item[1])):
        remarks = [uncertainty(max(float(needs.errors[name][need]) for name in names))]
        for axis in (ORDERED[dim] for dim in needs.axes if dim in ORDERED):
            judged = needs.analysis.sel(response=names)
            credible = np.isfinite(judged[f"{axis}_extrapolated"])
            orders = judged[f"{axis}_observed_order"].where(credible).values
            if np.isfinite(orders).any():
                order = labels.span(orders[np.isfinite(orders)], 2)
                remarks.append(f"observed order {order} in the {axis.replace('_', ' ')}")
        listed = labels.listing([labels.response(name) for name in names])
        head = f"Within {labels.percent(TOLERANCE)} from {needs.words(need)}"
        findings.append((head, f"{listed} ({', '.join(remarks)})"))
    beyond = []
    for name in [name for name in needs.errors if name not in needs.grids]:
        error = float(needs.errors[name].min())
        remarks = [uncertainty(error)] if error < 1 else []
        remarks += needs.doubts(name)
        beyond.append(f"{labels.response(name)} ({', '.join(remarks)})")
    return findings + ([("On no grid of this study", labels.listing(beyond))] if beyond else [])
