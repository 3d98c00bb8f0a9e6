"""The answer to a study's question: a headline, and at most four lines, in numbers."""

from collections import defaultdict
from math import isfinite

import numpy as np
import xarray as xr

from impactlab.analysis.analyse import analyse
from impactlab.figures import access, labels, measures
from impactlab.figures.access import design_dims, is_sample, responses
from impactlab.figures.distributions import spread_evenly
from impactlab.figures.measures import analysed
from impactlab.figures.needs import ORDERED, Needs, needed
from impactlab.methods.record import Family
from impactlab.model.parameters import PARAMETERS
from impactlab.report import effects, measured, ranking, strikes
from impactlab.report.distribution import limit_entries, regime_entries
from impactlab.report.page import Entry
from impactlab.report.sensitivity import history_entries, shared, uncertainty
from impactlab.variables import of_function
from impactlab.verdicts import TOLERANCE
from impactlab.verification.finding import gravest_first
from impactlab.verification.outcomes import unpacked

LINES = 5
"""Most lines of an answer, the headline among them."""
MINOR = (
    "time_of_peak_force",
    "number_of_contacts",
    "total_contact_time",
    "permanent_indentation",
    "impulse",
    "rebound_velocity",
    "remote_plastic_strain",
)
"""Responses that long answers leave to the tables."""
_OF_QUESTIONS = "Caution", "Sensitivity", "Saving", "The likeliest way to exceed it"


def answers(runs: xr.Dataset, analysis: xr.Dataset | None = None) -> list[str]:
    """Return the findings of a study in at most five lines, the headline first.

    Parameters
    ----------
    runs : xarray.Dataset
        Runs of a study as in runs.nc, the findings of a verification as in findings.nc, or a
        comparison of studies as in comparison.nc.
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
    x1 (... %), x2 (... %) and x3 (... %) cause most of the scatter of the value.
    """
    if runs.attrs.get("content") == "comparison":
        return str(runs.attrs["answer"]).splitlines()
    if analysis is None and runs.attrs.get("content") != "findings":
        analysis = analyse(runs)
    headline, lines, _ = entries(runs, analysis)
    sentences = ["; ".join(": ".join(entry) for entry in line) for line in lines]
    sentences = [f"{text}." for text in [headline, *sentences]]
    if analysis is not None and (correlated := shared(runs)):
        sentences[0] += f" {correlated}"
    return sentences


def entries(runs: xr.Dataset, analysis: xr.Dataset | None) -> tuple[str, list[list[Entry]], str]:
    """Return the headline of an answer, the entries of its other lines, and a note on the numbers.

    The headline is a sentence without its full stop. The answer leads to a question that the study
    asks beside its runs: about a slow model, or a rare event.
    """
    if analysis is None:
        headline, findings = _verification(runs)
        return headline, [[entry] for entry in findings[: LINES - 1]], ""
    headline, lines, note = _of_runs(runs, analysis)
    if answer := analysis.attrs.get("question_answer"):
        first, *rest = (line.removesuffix(".") for line in answer.splitlines())
        findings = [(subject, text) for subject, _, text in (line.partition(": ") for line in rest)]
        findings = [entry for entry in findings if entry[0] not in ("Allocation", "Runs")]
        # of further responses, the tables tell
        findings = findings[:1] + [entry for entry in findings[1:] if entry[0] in _OF_QUESTIONS]
        findings.sort(key=lambda entry: entry[0] != "Caution")
        lines = [[entry] for entry in (*findings[: LINES - 2], ("The sample alone", headline))]
        headline = first
    return headline, lines, note


def _of_runs(runs: xr.Dataset, analysis: xr.Dataset) -> tuple[str, list[list[Entry]], str]:
    shown = _stated(runs)
    if not shown:
        return "There is no answer in these runs", [], ""
    series = strikes.entries(runs)
    if (families := measures.families(runs, analysis)) and analysed(runs, analysis):
        headline, findings, note = _of_sample(runs, analysis, families)
        findings += series[:1]
    elif (needs := needed(runs, analysis)) and not _effects_lead(runs):
        headline, findings = _convergence(needs, access.leading(runs, [*needs.errors]))
        note = "± the difference to the finest grid and the numerical uncertainty of that grid."
        findings += series[:1]
    else:
        headline, findings, note = _of_grid(runs, analysis, shown, needs)
        if series:
            findings = [*series[1:], ("Last strike", headline), *findings]
            headline = series[0][1]
    first: list[Entry] = []
    if limits := limit_entries(runs, analysis):
        level, even = access.confidence(analysis), spread_evenly(runs)
        note = f"Above a limit: probability and its {level} interval{even}. {note}"
        subject = "Sensitivity" if families else "Range"
        first, headline = [(subject, headline), *limits[1:]], ": ".join(limits[0])
    first += regime_entries(runs)
    last = measured.entries(analysis)
    if over := history_entries(analysis):
        note += " Over time: generalised total order, of the variance added up over all times."
    room = LINES - 1 - bool(last)
    before, after = packed(first, 2), packed(over, 1 if findings or first else 2)
    lines = [*before, *packed(findings, room - len(before) - len(after)), *after]
    return headline, [*lines, last] if last else lines, note


def _stated(runs: xr.Dataset) -> list[str]:
    """Return the responses that an answer may state: of impacts, the energy error if alone."""
    names = responses(runs)
    if of_function(runs):
        return names
    return [name for name in names if name != "energy_error"] or names


def _effects_lead(runs: xr.Dataset) -> bool:
    """Return whether a grid has more values of the impact than of the discretisation."""
    dims = design_dims(runs)
    of_impact = [
        dim for dim in dims if dim not in PARAMETERS or PARAMETERS[dim].path[0] == "impact"
    ]
    further = [runs.sizes[dim] for dim in dims if dim not in of_impact]
    return bool(np.prod([runs.sizes[dim] for dim in of_impact]) > np.prod(further))


def _of_sample(
    runs: xr.Dataset, analysis: xr.Dataset, families: list[Family]
) -> tuple[str, list[Entry], str]:
    """Return headline, further entries and note of a sample with sensitivity indices."""
    family, names = families[0], analysed(runs, analysis)
    sound = [name for name in names if access.is_sound(analysis, name)]
    doubtful = ranking.unusable(runs, analysis)
    firsts = ranking.first_ranks(runs, analysis, family, [n for n in names if n not in sound])
    note = f"{family.title}, {family.ranked_by(analysis).label}, ± the half-width of the"
    note += f" {access.confidence(analysis)} interval. {shared(runs)}".rstrip()
    open_ranks = "matters most{}; intervals are too wide for the other ranks"
    if sound:
        lead = access.leading(runs, sound)
        headline = ranking.headline(runs, analysis, family, lead)
    elif firsts:
        lead = access.leading(runs, [*firsts])
        text = f"{firsts.pop(lead)} {open_ranks.format(f' for {ranking.subject(family, lead)}')}"
        headline = labels.sentence(text) if text.startswith("the ") else text
    else:
        return "No sensitivity index of this study is usable", doubtful, note
    findings = ranking.entries(runs, analysis, family, [name for name in sound if name != lead])
    for name, text in firsts.items():
        findings.append((labels.title(name), f"{text} {open_ranks.format('')}"))
    return headline, [*findings, *ranking.without_effect(analysis, family, sound), *doubtful], note


def _of_grid(
    runs: xr.Dataset, analysis: xr.Dataset, shown: list[str], needs: Needs | None
) -> tuple[str, list[Entry], str]:
    """Return headline, further entries and note of a grid: the effects of its parameters."""
    lead, note, findings = access.leading(runs, shown), "", list[Entry]()
    if is_sample(runs):
        return effects.spread(runs, lead), effects.ranges(runs, [n for n in shown if n != lead]), ""
    if len(shown) > 2 * LINES and not of_function(runs):
        shown = [name for name in shown if name not in MINOR or name == lead]
    if needs is not None:
        findings = [("Convergence", _convergence(needs, lead)[0])]
        runs = needs.runs.isel({axis: [0] for axis in needs.axes})
        note = "Effects are those on the finest grid."
    elif not of_function(runs) and "numerical_uncertainty" not in analysis:
        note = "The numerical uncertainty is not known: impactlab recommend measures it."
    headline = effects.headline(runs, lead)
    return headline, [*effects.entries(runs, analysis, lead, shown), *findings], note


def packed(findings: list[Entry], lines: int) -> list[list[Entry]]:
    """Return entries in at most so many lines."""
    size = max(1, -(-len(findings) // max(1, lines)))  # entries per line
    return [findings[first : first + size] for first in range(0, len(findings), size)]


def _verification(stored: xr.Dataset) -> tuple[str, list[Entry]]:
    """Return headline and further entries of a verification: failures, or the closest calls."""
    outcomes = gravest_first(unpacked(stored))
    total = sum(len(outcome.finding.comparisons) for outcome in outcomes)
    bad = [outcome for outcome in outcomes if outcome.verdict != "passed"]
    size = f"{labels.counted(total, 'comparison')} of {labels.counted(len(outcomes), 'check')}"
    headline = f"All {size} are within their tolerance"
    if bad or not outcomes:
        failed = sum(len(outcome.failures) for outcome in outcomes)
        checks = f"{labels.counted(len(bad), 'check')} did not pass"
        headline = f"{checks}: {failed} of {size} are not within their tolerance"
    closest = sorted(outcomes, key=lambda outcome: -(outcome.worst.ratio if outcome.worst else 0))
    findings, used = [], list[str]()
    for outcome in bad or closest:
        worst, text = outcome.worst, outcome.reason or "it compared nothing"
        if worst and not outcome.reason:
            share = labels.percent(worst.ratio) if isfinite(worst.ratio) else "infinitely much"
            used.append(f"{share} of its tolerance")
            text = f"uses {used[-1]} ({worst.quantity}, {worst.where})"
        findings.append((outcome.title, text))
    if not bad and used:
        headline += f"; the closest, “{closest[0].title}”, uses {used[0]}"
    return headline, findings


def _convergence(needs: Needs, lead: str) -> tuple[str, list[Entry]]:
    """Return headline and further entries: the grids that keep responses within tolerance.

    lead: the response that the headline is about, where a grid keeps it within tolerance.
    """
    groups: dict[tuple[int, ...], list[str]] = defaultdict(list)
    for name, need in needs.grids.items():
        groups[need].append(name)
    ordered = sorted(groups.items(), key=lambda item: (lead not in item[1], -len(item[1])))
    tolerance, findings = labels.percent(TOLERANCE), list[Entry]()
    headline = f"No response is within {tolerance} on any grid of this study"
    for need, names in ordered:
        remarks = [uncertainty(max(float(needs.errors[name][need]) for name in names))]
        for axis in (ORDERED[dim] for dim in needs.axes if dim in ORDERED):
            judged = needs.analysis.sel(response=names)
            credible = np.isfinite(judged[f"{axis}_extrapolated"])
            orders = judged[f"{axis}_observed_order"].where(credible).values
            if np.isfinite(orders).any():
                order = labels.span(orders[np.isfinite(orders)], 2)
                remarks.append(f"observed order {order} in the {axis.replace('_', ' ')}")
        listed = labels.listing([labels.response(name) for name in names])
        if not findings and headline.startswith("No"):
            verb = "is" if len(names) == 1 else "are"
            headline = f"With {needs.words(need)}, and on finer grids, the {listed} {verb} "
            headline += f"within {tolerance} ({', '.join(remarks)})"
        else:
            head = f"Within {tolerance} from {needs.words(need)}"
            findings.append((head, f"{listed} ({', '.join(remarks)})"))
    beyond = []
    for name in [name for name in needs.errors if name not in needs.grids]:
        error = float(needs.errors[name].min())
        remarks = [uncertainty(error)] if error < 1 else []
        remarks += needs.doubts(name)
        beyond.append(f"{labels.response(name)} ({', '.join(remarks)})")
    if beyond:
        findings.append(("On no grid of this study", labels.listing(beyond)))
    return headline, findings
