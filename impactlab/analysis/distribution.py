"""Distribution of each response of a sample, and the probability that it exceeds a limit.

Of a Saltelli sample the rows of A and of B alone are used: those between share columns with them,
and intervals from all would be too narrow. Intervals hold for independent rows; those of a Latin
hypercube or of a Sobol sequence spread more evenly, so that the intervals are wider than they need
to be (Stein 1987, Technometrics 29, 143).

A missing answer may lie anywhere: intervals of quantiles and probabilities allow for every value
that it could have. Mean, standard deviation and parameters beyond a limit are those of the rows
that answered; distribution_verdict says where these differ from the others in a parameter.
"""

import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np
import scipy  # its stats are loaded when first used
import xarray as xr
from numpy.typing import NDArray

from impactlab.methods import independent_runs, sobol
from impactlab.methods.runs import Sample, labels, listed, usable
from impactlab.types import Floats
from impactlab.verdicts import Verdict, flagged, names

PROBABILITIES = (0.01, 0.05, 0.1, 0.25, 0.5, 0.75, 0.9, 0.95, 0.99)
"""Probabilities below the quantiles."""


class DistributionVerdict(Verdict):
    """Verdicts on mean, standard deviation and quantiles of a response."""

    USABLE = True, "every draw has an answer"
    MISSING = True, "draws are missing, no more often at one value of a parameter than another"
    SELECTED = (
        False,
        "draws are missing more often at some values of a parameter: mean, standard deviation and "
        "quantiles are those of the others, and biased",
    )


def drawn_outputs(runs: xr.Dataset, response: str) -> Floats:
    """Return a response of the draws, (draws,), in SI units, NaN where it is missing."""
    sample = Sample.of(runs)
    return np.asarray(usable(sample.runs, response).values[0][independent_runs(sample)])


def limits(runs: xr.Dataset) -> dict[str, float]:
    """Return the limits that the study states, in SI units, by response."""
    if "limited" not in runs.attrs:
        return {}
    values = np.atleast_1d(runs.attrs["limits"]).tolist()
    return dict(zip(listed(runs, "limited"), values, strict=True))


def analysis(runs: xr.Dataset) -> xr.Dataset:
    """Return moments, quantiles and exceedance probabilities of every response of a sample.

    Returns the variables of _VARIABLES on `response` and the dimensions there; those from `limit`
    on where the study states limits, NaN for responses that have none.

    Raises ValueError when the runs are not the sample that their attributes describe.
    """
    sample = Sample.of(runs)
    if sample.settings["method"] == "sobol":
        sobol.check(sample)
    rows, level, bounds = independent_runs(sample), sample.confidence, limits(runs)
    columns = {name: sample.runs[name].values[rows] for name in sample.parameters if bounds}
    entries: list[dict[str, Any]] = []
    verdicts = []
    for name in listed(runs, "responses"):
        outputs = drawn_outputs(sample.runs, name)
        entries.append(_moments(outputs, level) | _quantiles(outputs, level))
        verdicts.append(_verdict(outputs, sample, rows))
        if bounds:
            limit = bounds.get(name, np.nan)
            entries[-1] |= _exceedance(outputs, limit, level) | filtered(outputs, limit, columns)
    variables: dict[str, Any] = {}
    percent = f"{100 * level:g} %"
    for name, (dims, units, long_name) in _VARIABLES.items():
        if name in entries[0]:
            attrs = {"long_name": long_name.format(percent)} | ({"units": units} if units else {})
            stacked = np.array([entry[name] for entry in entries])
            variables[name] = (("response", *dims), stacked, attrs)
    codes = xr.DataArray([int(verdict) for verdict in verdicts], dims="response")
    variables["distribution_verdict"] = flagged(
        codes, DistributionVerdict, "verdict on the moments"
    )
    coordinates = labels(runs)
    attrs = {"long_name": "probability of a response below its quantile", "units": "1"}
    coordinates["probability"] = ("probability", list(PROBABILITIES), attrs)
    if bounds:
        attrs = {"long_name": "varied parameter, by itself"}
        coordinates["varied_parameter"] = ("varied_parameter", list(sample.parameters), attrs)
    return xr.Dataset(variables, coordinates)


_VARIABLES: dict[str, tuple[tuple[str, ...], str, str]] = {
    "number_of_draws": ((), "1", "rows of the sample that are independent draws"),
    "missing_draws": ((), "1", "of these, rows without a usable value"),
    "mean": ((), "", "mean of the rows that answered"),
    "mean_interval": ((), "", "half-width of the {} interval of the mean, by Student's t"),
    "standard_deviation": ((), "", "standard deviation of the rows that answered"),
    "standard_deviation_interval": (
        (),
        "",
        "half-width of the {} interval of the standard deviation, from the fourth moment",
    ),
    "quantile": (("probability",), "", "quantile of the rows that answered"),
    "quantile_low": (
        ("probability",),
        "",
        "lower end of the {} interval of the quantile, by order statistics, wherever missing "
        "answers lie; NaN where the sample is too small for one",
    ),
    "quantile_high": (("probability",), "", "upper end of the same"),
    "limit": ((), "", "limit that the study states"),
    "exceeding_draws": ((), "1", "rows above the limit"),
    "exceedance_probability": ((), "1", "share of the rows that answered above the limit"),
    "exceedance_low": (
        (),
        "1",
        "lower end of the {} interval of the exceedance probability (Clopper and Pearson 1934, "
        "Biometrika 26, 404), if no missing answer exceeds the limit",
    ),
    "exceedance_high": ((), "1", "upper end of the same, if every missing answer does"),
    "exceedance_if_none": ((), "1", "share of all rows, if no missing answer exceeds the limit"),
    "exceedance_if_all": ((), "1", "share of all rows, if every missing answer does"),
    "exceedance_distance": (
        ("varied_parameter",),
        "1",
        "distance of Kolmogorov and Smirnov (of words: total variation) between the parameter in "
        "rows above the limit and in the others (Monte Carlo filtering: Hornberger and Spear 1981, "
        "J. Environ. Manage. 12, 7, as recalled)",
    ),
    "exceedance_direction": (
        ("varied_parameter",),
        "1",
        "1 where the parameter is larger in rows above the limit, -1 where smaller, 0 for words",
    ),
    "exceedance_p_value": (
        ("varied_parameter",),
        "1",
        "probability of this distance, or of more, if the parameter does not matter",
    ),
}
"""By name: dimensions beside `response`, units ("": those of the response), meaning."""


def _moments(outputs: Floats, level: float) -> dict[str, float]:
    """Return counts and moments of outputs (draws,), NaN where there are too few."""
    values = outputs[~np.isnan(outputs)]
    counts = {"number_of_draws": outputs.size, "missing_draws": outputs.size - values.size}
    names = ("mean", "mean_interval", "standard_deviation", "standard_deviation_interval")
    if values.size < 2:
        mean = float(values.mean()) if values.size else np.nan
        return counts | dict.fromkeys(names, np.nan) | {"mean": mean}
    deviation = float(values.std(ddof=1))
    centred = values - values.mean()
    second, fourth = (float((centred**power).mean()) for power in (2, 4))
    # of the variance, through d(sigma) = d(sigma^2) / (2 sigma)
    error = np.sqrt(max(fourth - second**2, 0.0) / values.size) / (2 * deviation or 1.0)
    upper = 0.5 + level / 2
    student = float(scipy.stats.t.ppf(upper, values.size - 1))
    margins = student * deviation / np.sqrt(values.size), scipy.stats.norm.ppf(upper) * error
    moments = float(values.mean()), margins[0], deviation, margins[1]
    return counts | dict(zip(names, moments, strict=True))


def _quantiles(outputs: Floats, level: float) -> dict[str, Floats]:
    """Return quantiles of outputs (draws,) and the ends of their intervals, (probability,)."""
    gaps = np.isnan(outputs)
    if gaps.all():
        gap = np.full(len(PROBABILITIES), np.nan)
        return dict.fromkeys(("quantile", "quantile_low", "quantile_high"), gap)
    lower = upper = _order_statistics(outputs, level)
    if gaps.any():
        lower, upper = (
            _order_statistics(np.where(gaps, value, outputs), level) for value in (-np.inf, np.inf)
        )
    quantile = np.quantile(outputs[~gaps], PROBABILITIES)
    return {"quantile": quantile, "quantile_low": lower[0], "quantile_high": upper[1]}


def _order_statistics(outputs: Floats, level: float) -> Floats:
    """Return the ends of intervals of quantiles, (2, probability), NaN where nothing bounds one."""
    # scipy.stats.quantile_test, for one at a time, takes 50 times as long
    count, tail = scipy.stats.binom(outputs.size, PROBABILITIES), (1 - level) / 2
    places = np.array([count.ppf(tail), count.isf(tail) + 1], int)
    ends = np.concatenate([[-np.inf], np.sort(outputs), [np.inf]])[places]
    return np.where(np.isfinite(ends), ends, np.nan)


def _exceedance(outputs: Floats, limit: float, level: float) -> dict[str, float]:
    """Return the probability that outputs (draws,) exceed a limit; NaN without limit or outputs."""
    total, missing = outputs.size, int(np.isnan(outputs).sum())
    names = ("probability", "low", "high", "if_none", "if_all")
    if np.isnan(limit) or missing == total:
        values, above = [np.nan] * len(names), np.nan if np.isnan(limit) else 0.0
    else:
        above = int((outputs > limit).sum())
        # Two-sided for no and for all rows, too: a one-sided bound for these alone covers less.
        fewest = most = scipy.stats.binomtest(above, total).proportion_ci(level)
        if missing:
            most = scipy.stats.binomtest(above + missing, total).proportion_ci(level)
        ends = above / total, (above + missing) / total
        shares = above / (total - missing), fewest.low, most.high, *ends
        values = list(map(float, shares))
    exceedance = {f"exceedance_{name}": value for name, value in zip(names, values, strict=True)}
    return {"limit": limit, "exceeding_draws": above} | exceedance


def filtered(outputs: Floats, limit: float, columns: dict[str, Any]) -> dict[str, list[float]]:
    """Return how far parameters (draws,) of outputs above the limit are from those of others."""
    answered, above = ~np.isnan(outputs), outputs > limit
    other = answered & ~above
    rows: list[tuple[float, float, float]] = []
    for values in columns.values():
        if np.isnan(limit) or not above.any() or not other.any():
            rows.append((np.nan, np.nan, np.nan))
        elif values.dtype.kind in "if":
            with warnings.catch_warnings():  # that it takes the asymptotic value
                warnings.simplefilter("ignore", RuntimeWarning)
                test = scipy.stats.ks_2samp(values[above], values[other])
            # +1 where the cumulative distribution of those above the limit is the larger one
            rows.append((test.statistic, -test.statistic_sign, test.pvalue))
        else:
            categories = np.unique(values[answered])
            table = np.array(
                [[(values[which] == word).sum() for word in categories] for which in (above, other)]
            )
            shares = table / table.sum(axis=1, keepdims=True)
            distance = 0.5 * float(np.abs(shares[0] - shares[1]).sum())
            rows.append((distance, 0.0, float(scipy.stats.chi2_contingency(table).pvalue)))
    names = ("exceedance_distance", "exceedance_direction", "exceedance_p_value")
    return {name: [float(row[position]) for row in rows] for position, name in enumerate(names)}


def _verdict(outputs: Floats, sample: Sample, rows: NDArray[np.int64]) -> DistributionVerdict:
    """Return whether answers are missing, and more often at some values of a parameter.

    By the tests of `filtered`, at the level of the intervals shared among the parameters.
    """
    missing = np.isnan(outputs)
    if not missing.any():
        return DistributionVerdict.USABLE
    columns = {name: sample.runs[name].values[rows] for name in sample.parameters}
    values = np.array(filtered(missing.astype(float), 0.5, columns)["exceedance_p_value"])
    if (values < (1 - sample.confidence) / values.size).any():
        return DistributionVerdict.SELECTED
    return DistributionVerdict.MISSING


def significance(analysis: xr.Dataset) -> float:
    """Return the p-value below which a parameter matters, after Bonferroni."""
    confidence = float(analysis.attrs.get("confidence", 0.95))
    return (1 - confidence) / analysis.sizes["varied_parameter"]


def cumulative(outputs: Floats, level: float) -> tuple[Floats, Floats, Floats, Floats]:
    """Return the distinct values of outputs (draws,), the share up to each, and its band.

    The band holds the whole distribution at once, wherever missing answers (NaN) lie: Dvoretzky,
    Kiefer and Wolfowitz (1956) with the constant of Massart (1990), Ann. Probab. 18, 1269.
    """
    values, counts = np.unique(outputs[~np.isnan(outputs)], return_counts=True)
    below, total = counts.cumsum(), outputs.size
    missing, answered = total - int(counts.sum()), max(int(counts.sum()), 1)
    reach = np.sqrt(np.log(2 / (1 - level)) / (2 * max(total, 1)))
    low, high = below / total - reach, (below + missing) / total + reach
    return values, below / answered, np.clip(low, 0.0, 1.0), np.clip(high, 0.0, 1.0)


_NUMBER = ("quantity", "at", "value", "low", "high", "units")
COLUMNS = ("response", *_NUMBER, "draws", "missing", "verdict")
"""Of the table. at: probability, limit or parameter. low, high: ends of the interval."""


def table_rows(analysis: xr.Dataset) -> Iterator[dict[str, Any]]:
    """Yield every number of the distributions by COLUMNS, NaN where there is none."""
    for name in analysis["response"].values.tolist() if "quantile" in analysis else ():
        entry = analysis.sel(response=name)
        row = {
            "response": name,
            "draws": int(entry["number_of_draws"]),
            "missing": int(entry["missing_draws"]),
            "verdict": names(DistributionVerdict)[int(entry["distribution_verdict"])],
        }
        for numbers in _numbers(entry):
            yield row | dict(zip(_NUMBER, numbers, strict=True))


def _numbers(entry: xr.Dataset) -> Iterator[tuple[Any, ...]]:
    """Yield every number of one response, as the columns _NUMBER."""
    units = str(entry["response_units"].item())
    for key in ("mean", "standard_deviation"):
        value, margin = float(entry[key]), float(entry[f"{key}_interval"])
        yield key, "", value, value - margin, value + margin, units
    columns = ("probability", "quantile", "quantile_low", "quantile_high")
    for numbers in zip(*(entry[column].values.tolist() for column in columns), strict=True):
        yield "quantile", *numbers, units
    if "limit" not in entry or np.isnan(limit := float(entry["limit"])):
        return
    low, high = float(entry["exceedance_low"]), float(entry["exceedance_high"])
    probability = float(entry["exceedance_probability"])
    yield "exceedance_probability", limit, probability, low, high, "1"
    for key in ("exceedance_if_none", "exceedance_if_all"):
        yield key, limit, float(entry[key]), np.nan, np.nan, "1"
    for key in ("exceedance_distance", "exceedance_direction", "exceedance_p_value"):
        for parameter, value in entry[key].to_series().items():
            yield key, parameter, value, np.nan, np.nan, "1"
