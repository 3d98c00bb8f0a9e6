"""HSIC: how strongly a response depends on a parameter in any way, and whether it does at all.

The Hilbert-Schmidt independence criterion (Gretton et al. 2005) is zero if and only if response and
parameter are independent. R2 is that of the two over the root of the product of each with itself
(Da Veiga 2015), from 0 to 1. Kernels are Gaussian, as wide as the standard deviation; words are
alike or not. The estimator is free of the bias that noise makes (Song et al. 2012, eq. 5), so that
R2 may be below zero by noise alone.

The half-width combines the standard error, from what each run adds to the three criteria, and the
standard deviation that shuffled runs have, which alone is left where they are independent. The
p-value is the share of shuffles with a larger criterion: below 0.05, dependence is told apart from
noise. Target indices (Marrel and Chabridon 2021) are those of whether the limit is exceeded.
"""

from collections.abc import Mapping

import numpy as np

from impactlab.methods.hypercube import Hypercube
from impactlab.methods.record import (
    Family,
    IndexVariable,
    Indices,
    Measure,
    SensitivityVerdict,
    by_width,
    wide,
)
from impactlab.methods.runs import Sample, listed
from impactlab.types import Floats

MOST = 2000
"""Most runs that are used: their pairs are held in memory."""
SAFETY = 1.2  # standard errors of 256 runs are up to 1.16 times too small
_2021 = "Marrel and Chabridon (2021), Reliab. Eng. Syst. Saf. 206, 107283"
_2015 = "Da Veiga (2015), J. Stat. Comput. Simul. 85, 1283, eq. 12; Song et al. (2012), eq. 5"
_SHARE = f"of the first {MOST} runs of a larger sample; below zero by noise alone"


def _variables(name: str, of: str, source: str) -> dict[str, IndexVariable]:
    return {
        name: IndexVariable(f"HSIC index R2{of}", source, comment=_SHARE),
        f"{name}_p_value": IndexVariable(
            f"p-value of independence{of}", source, interval=False, comment="by shuffles"
        ),
    }


def _family(name: str, of: str) -> Family:
    words = name.replace("_", " ").replace("hsic", "HSIC")
    return Family(
        f"{name}_indices",
        f"{words[0].upper()}{words[1:]} indices",
        (Measure(name, words),),
        "R² (–)",
        f"Strength of any dependence{of} on a parameter, 0 for none; not a share of the variance.",
        shares=False,
    )


def _estimate(outputs: Floats, sample: Sample, response: str) -> dict[str, Floats]:
    return _named("hsic", sample, _gaussian(outputs[:MOST]), response)


def _estimate_target(outputs: Floats, sample: Sample, response: str) -> dict[str, Floats]:
    limits = np.atleast_1d(sample.settings["limits"]).tolist()
    limit = dict(zip(listed(sample.runs, "limited"), limits, strict=True)).get(response, np.nan)
    return _named("target_hsic", sample, _alike(outputs[:MOST] > limit), response)


def _named(name: str, sample: Sample, kernel: Floats, response: str) -> dict[str, Floats]:
    """Return indices, half-widths and p-values by variable name; NaN where the kernel is even."""
    rng, size = sample.rng("shuffles", response), len(kernel)
    shuffles = rng.permuted(np.tile(np.arange(size), (sample.resamples, 1)), axis=1)
    values, margins, p_values = np.full((3, len(sample.parameters)), np.nan)
    for number, parameter in enumerate(sample.parameters if np.ptp(kernel) > 0.0 else ()):
        column = sample.column(parameter)[:MOST]
        other = _alike(column) if parameter in sample.words else _gaussian(column)
        values[number], error, null = r_squared(other, kernel, shuffles)
        margins[number] = sample.quantile * np.hypot(SAFETY * error, null.std())
        p_values[number] = (1 + np.count_nonzero(null >= values[number])) / (1 + len(null))
    return {name: values, f"{name}_interval": margins, f"{name}_p_value": p_values}


def _gaussian(values: Floats) -> Floats:
    scaled = values / values.std()
    return np.asarray(np.exp(-0.5 * (scaled[:, np.newaxis] - scaled) ** 2))


def _alike(values: Floats) -> Floats:
    return np.asarray(values[:, np.newaxis] == values, float)


def r_squared(kernel: Floats, other: Floats, shuffles: Floats) -> tuple[float, float, Floats]:
    """Return R2 of two kernels, (runs, runs), its standard error, and R2 of shuffles of the second.

    shuffles: (shuffles, runs), orders of the runs.
    """
    first, second = _hollow(kernel), _hollow(other)
    both, one, two = (
        _criterion(*pair) for pair in ((first, second), (first, first), (second, second))
    )
    scale = float(np.sqrt(one * two))
    centred, other_centred = _centred(kernel), _centred(other)
    of_both, of_one, of_two = (
        np.mean(part * counterpart, axis=1)
        for part, counterpart in (
            (centred, other_centred),
            (centred, centred),
            (other_centred, other_centred),
        )
    )
    influence = of_both / scale - 0.5 * both / scale * (of_one / one + of_two / two)
    error = 2.0 * influence.std() / np.sqrt(len(influence))  # each run is in every pair twice
    null = [_criterion(first, second[order][:, order]) / scale for order in shuffles]
    return both / scale, float(error), np.array(null)


def _hollow(kernel: Floats) -> Floats:
    hollow = kernel.copy()
    np.fill_diagonal(hollow, 0.0)
    return hollow


def _criterion(first: Floats, second: Floats) -> float:
    """Return the criterion without bias (Song et al. 2012, eq. 5) of kernels without diagonals."""
    n, rows, others = len(first), first.sum(axis=1), second.sum(axis=1)
    # sums of NumPy's own, whose bits do not depend on the number of threads
    whole = rows.sum() * others.sum() / ((n - 1) * (n - 2))
    mixed = 2.0 * np.sum(rows * others) / (n - 2)
    return float((np.sum(first * second) + whole - mixed) / (n * (n - 3)))


def _centred(kernel: Floats) -> Floats:
    means = kernel.mean(axis=0)
    return np.asarray(kernel - means - means[:, np.newaxis] + means.mean())


def _judge_target(indices: Mapping[str, Floats]) -> list[SensitivityVerdict]:
    if np.isnan(indices["target_hsic"]).all():
        return [SensitivityVerdict.NO_LIMIT]
    return wide(indices["target_hsic_interval"])


INDICES = Indices(
    "hsic",
    _variables("hsic", "", _2015),
    _family("hsic", " of the response"),
    Sample.ungrouped,
    _estimate,
    by_width("hsic"),
    fewest=64,
)
TARGET = Indices(
    "target_hsic",
    _variables("target_hsic", " of exceeding the limit", _2021),
    _family("target_hsic", " of whether the limit is exceeded"),
    Sample.ungrouped,
    _estimate_target,
    _judge_target,
    fewest=64,
    of_limits=True,
)


class Hsic(Hypercube):
    """A Latin hypercube for HSIC indices.

    {arguments}

    References
    ----------
    Da Veiga (2015), J. Stat. Comput. Simul. 85, 1283.

    {example}
    """

    records = (INDICES,)
    label = "Latin hypercube for HSIC indices"


class TargetHsic(Hypercube):
    """A Latin hypercube for HSIC indices of whether the limits of a study are exceeded.

    {arguments}

    References
    ----------
    Marrel and Chabridon (2021), Reliab. Eng. Syst. Saf. 206, 107283.

    {example}
    """

    records = (TARGET,)
    label = "Latin hypercube for target HSIC indices"
