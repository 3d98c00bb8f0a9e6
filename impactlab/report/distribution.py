"""Distributions of the responses of a sample, their regimes, and limits: tables and sentences."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from impactlab.analysis.distribution import (
    DistributionVerdict,
    drawn_outputs,
    filtered,
    limits,
    significance,
)
from impactlab.analysis.regimes import of_runs
from impactlab.figures import access, labels
from impactlab.figures.access import responses
from impactlab.figures.distributions import exceedance, limited, spread_evenly
from impactlab.figures.labels import Display, display
from impactlab.methods import independent_runs
from impactlab.methods.runs import Sample, correlations
from impactlab.report.page import Cell, Entry, Row, Section, Table
from impactlab.types import Floats

PERCENTILES = {"5th percentile": 0.05, "Median": 0.5, "95th percentile": 0.95}
_COUNTS = ("number_of_draws", "missing_draws", "exceeding_draws")
_NAMED = 2  # largest number of parameters that an answer names
_LEAD = (
    "A probability is the share of the independent draws of the sample that lie above the limit, "
    "with the interval of Clopper and Pearson{even}. It is that of the model with these "
    "distributions of its parameters; the error of the model is not in it."
)
_MISSING = (
    " Missing answers may lie on either side of the limit: the interval reaches from the case that "
    "none of them is above it to the case that all are."
)
_READING = (
    "Distance of Kolmogorov and Smirnov between the parameter in runs above the limit and in the "
    "others: 0 where both have the same distribution, 1 where they do not overlap (of words: half "
    "the sum of the differences of their shares). Larger, smaller: in runs above the limit. Grey: "
    "no significant difference at the level of the intervals, shared among the parameters "
    "(Bonferroni)."
)
_SHARED = " Of correlated parameters each distance includes what one shares with the others."


def limit_entries(runs: xr.Dataset, analysis: xr.Dataset) -> list[Entry]:
    """Return one entry per limit: its probability, and the parameters that lead beyond it."""
    entries = []
    for name in limited(runs, analysis):
        text, led = probability(analysis.sel(response=name)), leading(runs, analysis, name)
        response = labels.title(name)
        if led:
            text += f"; runs above it have {led}"
        entries.append((f"{response} above {labels.amount(runs[name], limits(runs)[name])}", text))
    return entries


def probability(statistics: xr.Dataset) -> str:
    """Return the probability that one response exceeds its limit, with its interval, in words.

    statistics: the analysis of the response.
    """
    total, missing, above = (int(np.nan_to_num(statistics[key])) for key in _COUNTS)
    low, high = (float(statistics[f"exceedance_{end}"]) for end in ("low", "high"))
    if np.isnan(low):
        return f"unknown, for none of {labels.counted(total, 'draw')} has an answer"
    draws = labels.counted(total, "draw")
    if not missing and above == 0:
        return f"at most {_percent(high, high)} (none of {draws})"
    if not missing and above == total:
        return f"at least {_percent(low, 1 - low)} (all of {draws})"
    mean, none, every = (
        _percent(float(statistics[f"exceedance_{key}"]), high - low)
        for key in ("probability", "if_none", "if_all")
    )
    ends = f"{_percent(low, high - low).removesuffix(' %')} to {_percent(high, high - low)}"
    if missing:
        ends += f"; {missing:,} of {draws} {'is' if missing == 1 else 'are'} missing: "
        ends += f"{none} if none of them is above, {every} if all are"
    return f"{mean} ({ends})"


def _percent(share: float, width: float) -> str:
    """Return a share in per cent, with the digits that an interval of this width leaves."""
    decimals = int(np.clip(1 - np.floor(np.log10(100 * width)), 0, 8)) if width > 0 else 0
    return f"{100 * share:.{decimals}f} %"


def leading(runs: xr.Dataset, analysis: xr.Dataset, name: str) -> str:
    """Return the parameters that differ most in runs above the limit; "" where none does."""
    statistics = analysis.sel(response=name)
    matters = (statistics["exceedance_p_value"] < significance(analysis)).values
    distances = np.where(matters, statistics["exceedance_distance"].values, 0.0)
    differences = []
    for number in np.argsort(-distances, kind="stable")[:_NAMED].tolist():
        if matters[number]:
            parameter = labels.parameter(runs[str(statistics["varied_parameter"].values[number])])
            differences.append(
                f"{_direction(statistics, number)} {parameter} (distance {distances[number]:.2f})"
            )
    return labels.listing(differences)


def _direction(statistics: xr.Dataset, number: int) -> str:
    return {1: "larger", -1: "smaller"}.get(
        int(statistics["exceedance_direction"][number]), "another"
    )


def limit_sections(runs: xr.Dataset, analysis: xr.Dataset) -> list[Section]:
    """Return the section on the limits of the study; none where it has none."""
    if not (names := limited(runs, analysis)):
        return []
    gaps = bool((analysis["missing_draws"].sel(response=names) > 0).any())
    rows: list[Row] = []
    apart: list[Row] = []
    for name in names:
        statistics = analysis.sel(response=name)
        counts = [Cell(f"{int(np.nan_to_num(statistics[key])):,}", "number") for key in _COUNTS]
        response = labels.title(name)
        text = Cell(probability(statistics), "number")
        limit = labels.amount(runs[name], limits(runs)[name])
        rows.append([response, limit, *counts, text])
        if statistics["exceedance_distance"].notnull().any():
            apart.append([response, *_distances(analysis, statistics)])
    parameters = [
        labels.sentence(labels.parameter(runs[str(parameter)]))
        for parameter in analysis["varied_parameter"].values
    ]
    level = access.confidence(analysis)
    head = ["Response", "Limit", "Draws", "Missing", "Above the limit", f"Probability ({level})"]
    tables = [Table("Probability that a response exceeds its limit", head, rows)]
    if apart:
        caption = "Parameters in runs above the limit beside the others"
        reading = _READING + _SHARED if correlations(runs) else _READING
        tables.append(Table(caption, ["Response", *parameters], apart, [reading]))
    lead = _LEAD.format(even=spread_evenly(runs))
    if gaps:
        lead += _MISSING
    figures = [exceedance(name).name for name in names]
    return [Section("limits", "Limits", lead, tables=tables, figures=figures)]


def _distances(analysis: xr.Dataset, statistics: xr.Dataset) -> list[Cell]:
    matter = (statistics["exceedance_p_value"] < significance(analysis)).values
    return [
        Cell(
            f"{distance:.2f}",
            "number" if matter[number] else "muted",
            _direction(statistics, number),
        )
        for number, distance in enumerate(statistics["exceedance_distance"].values.tolist())
    ]


def summary(analysis: xr.Dataset, name: str, unit: Display) -> list[Cell]:
    """Return mean, standard deviation and PERCENTILES of a response, with their intervals below."""
    statistics, cells = analysis.sel(response=name), []
    biased = int(statistics["distribution_verdict"]) == DistributionVerdict.SELECTED
    for key in ("mean", "standard_deviation"):
        value, margin = (float(unit(statistics[field])) for field in (key, f"{key}_interval"))
        cells.append(_number(value, f"± {labels.number(margin, 2)}", biased))
    for probability in PERCENTILES.values():
        percentile = statistics.sel(probability=probability)
        value, low, high = (
            float(unit(percentile[key])) for key in ("quantile", "quantile_low", "quantile_high")
        )
        cells.append(_number(value, _range(low, high), biased))
    return cells


def _number(value: float, detail: str, biased: bool) -> Cell:
    if np.isnan(value):
        return Cell("missing", "warning")
    kind = "warning" if biased else "number"
    return Cell(labels.number(value), kind, "" if "missing" in detail else detail)


def _range(low: float, high: float) -> str:
    if np.isnan(low) and np.isnan(high):
        return "no bound"
    if np.isnan(low) or np.isnan(high):
        return f"above {labels.number(low)}" if np.isnan(high) else f"below {labels.number(high)}"
    return f"{labels.number(low)} to {labels.number(high)}"


def remarks(runs: xr.Dataset, analysis: xr.Dataset) -> list[str]:
    """Return what the numbers of `summary` are."""
    total, gaps = (analysis[key].max().item() for key in ("number_of_draws", "missing_draws"))
    draws, level = labels.counted(int(total), "independent draw"), access.confidence(analysis)
    basis = (
        f"Mean, standard deviation and percentiles are those of the {draws} of the sample, below "
        f"them their {level} intervals{spread_evenly(runs)}: by Student's t, by the fourth moment, "
        "and by order statistics."
    )
    missing = (
        "Where answers are missing, mean and standard deviation are those of the others; intervals "
        "of percentiles allow for any value that a missing answer could have."
    )
    codes = analysis["distribution_verdict"]
    biased = analysis["response"].values[codes.values == DistributionVerdict.SELECTED].tolist()
    warning = f"{labels.listing([labels.response(name) for name in biased])}: "
    warning = labels.sentence(warning + DistributionVerdict.SELECTED.meaning) + "."
    return [basis, *([missing] if gaps else []), *([warning] if biased else [])]


HEADS: Sequence[str] = ("Mean", "Standard deviation", *PERCENTILES)
"""Heads of the columns of `summary`."""


def regime_entries(runs: xr.Dataset) -> list[Entry]:
    """Return one entry per response of a sample in several regimes: where draws lie, and why."""
    entries = []
    for name in responses(runs):
        if (middles := of_runs(runs, name)).size:
            subject = f"{labels.title(name)} in several regimes"
            entries.append((subject, _regimes(runs, name, middles)))
    return entries


def _regimes(runs: xr.Dataset, name: str, middles: Floats) -> str:
    """Return the range of each regime, and the parameters that decide between them."""
    values, unit = drawn_outputs(runs, name), display(runs[name])
    places = np.where(np.isfinite(values), np.searchsorted(middles, values), np.nan)
    parts = [unit(values[places == place]) for place in range(middles.size + 1)]
    common = max(range(len(parts)), key=lambda place: parts[place].size)
    total, usual = np.isfinite(places).sum(), float(np.median(parts[common]))
    texts = []
    for part in (part for part in parts if part is not parts[common]):
        text = f"{labels.span(part, 3)}{labels.unit(runs[name])}"
        if usual > 0 and (ratio := float(np.median(part)) / usual) > 0:
            text = f"about {labels.number(ratio, 2)} times as much ({text})"
        texts.append(f"{text} in {labels.percent(part.size / total)}")
    text = f"{labels.span(parts[common], 3)}{labels.unit(runs[name])} in "
    text += f"{labels.percent(parts[common].size / total)} of the draws, but "
    text += f"{labels.listing(texts)}, and none between"
    apart = np.where(np.isfinite(places), places != common, np.nan)
    if decisive := _decisive(runs, name, apart):
        text += f"; the latter have {decisive}"
    return f"{text}; no mean, index or surrogate describes them all"


def _decisive(runs: xr.Dataset, name: str, apart: Floats) -> str:
    """Return the parameters that differ most between runs apart (1) and the others (0)."""
    sample = Sample.of(runs.assign_attrs(responses=name))
    rows = independent_runs(sample)
    columns = {key: sample.runs[key].values[rows] for key in sample.parameters}
    columns = {key: column for key, column in columns.items() if np.unique(column).size > 1}
    variables = {
        key: (("response", "varied_parameter"), [numbers])
        for key, numbers in filtered(apart, 0.5, columns).items()
    }
    coordinates = {"response": [name], "varied_parameter": list(columns)}
    return leading(runs, xr.Dataset(variables, coordinates, runs.attrs), name)


def regime_doubt(runs: xr.Dataset, name: str) -> str:
    """Return what is wrong with a mean of a response in several regimes; "" for one regime."""
    if number := of_runs(runs, name).size:
        return f"{number + 1} separate ranges: mean and standard deviation describe none of them"
    return ""
