"""PAWN: how far the distribution of a response moves when a parameter is held, by SALib.

The distance is that of Kolmogorov and Smirnov between the runs of a slide, a tenth of the values of
the parameter, and all runs. It needs no density and no variance, so that jumps and skewed responses
are no trouble; it is never zero in a finite sample, which is what the dummy shows. The slides of a
parameter that takes words are the words, and the median is that over the runs.
"""

from __future__ import annotations

import warnings

import numpy as np
import numpy.typing as npt
from SALib.analyze import pawn

from impactlab.analysis.responses import Sample
from impactlab.analysis.sensitivity.method import (
    Index,
    Method,
    apart_from_dummy,
    counts,
    dummy_column,
)
from impactlab.types import Floats

SLIDES = 10  # classes of a parameter's values, as in SALib
FEWEST = 10  # runs that a slide needs on average
_2018 = "Pianosi and Wagener (2018), Environ. Model. Softw. 108, 197"
_INDICES = {
    "pawn": Index("PAWN index, median over the slides", f"{_2018}, eqs. 2 and 3"),
    "pawn_maximum": Index(
        "PAWN index, maximum over the slides", f"{_2018}, eqs. 2 and 3", interval=False
    ),
    "dummy_pawn": Index.of_dummy("PAWN index of a dummy", f"{_2018}, section 2.3"),
}


def _check(sample: Sample) -> None:
    sample.ungrouped()
    if (runs := len(sample.inputs)) < SLIDES * FEWEST:
        raise ValueError(
            f"{sample.study}: {runs} runs are too few for PAWN: take {SLIDES * FEWEST} or more"
        )


def _estimate(outputs: Floats, sample: Sample, response: str) -> dict[str, Floats]:
    words = np.array([*(name in sample.words for name in sample.parameters), False])
    inputs = np.column_stack([sample.inputs, dummy_column(sample)])
    numbers = inputs[:, ~words]
    names = [str(at) for at in range(numbers.shape[1])]
    with warnings.catch_warnings():
        # of the significance of a distance, which is not used
        warnings.filterwarnings("ignore", "ks_2samp", RuntimeWarning)
        given = pawn.analyze({"num_vars": len(names), "names": names}, numbers, outputs, S=SLIDES)
    order = np.argsort(outputs, kind="stable")
    last = np.flatnonzero(np.diff(outputs[order], append=np.inf))
    # the limits are kept in resamples
    members = [
        (column[:, None] == np.unique(column) if of_words else slides(column))[order]
        for column, of_words in zip(inputs.T, words, strict=True)
    ]
    medians = [
        [_median(row[order], *each, last)[0] for each in zip(members, words, strict=True)]
        for tally in counts(len(outputs), sample.resamples, sample.rng(response))
        for row in tally
    ]
    margins = sample.half_width(np.array(medians))
    median, largest = np.empty((2, words.size))
    median[~words], largest[~words] = given["median"], given["maximum"]
    for at in np.flatnonzero(words):
        median[at], largest[at] = _median(np.ones(len(outputs)), members[at], True, last)
    return apart_from_dummy("pawn", median, margins) | {"pawn_maximum": largest[:-1]}


def _median(
    weights: Floats, members: npt.NDArray[np.bool_], words: bool, last: npt.NDArray[np.intp]
) -> tuple[float, float]:
    """Return median and maximum of the `distances` of the slides with runs, as in SALib."""
    apart = distances(weights, members, last)
    if words:  # each counts by how often it is drawn
        apart = np.repeat(apart, (weights @ members).astype(int))
    return float(np.nanmedian(apart)), float(np.nanmax(apart))


def slides(column: Floats) -> npt.NDArray[np.bool_]:
    """Return which runs lie in which slide, (runs, slides); SALib omits the largest value."""
    limits = np.quantile(column, np.linspace(0, 1, SLIDES + 1))
    return (column[:, None] >= limits[:-1]) & (column[:, None] < limits[1:])


def distances(
    weights: Floats, members: npt.NDArray[np.bool_], last: npt.NDArray[np.intp]
) -> Floats:
    """Return the Kolmogorov-Smirnov distance of each slide from all runs, (slides,).

    weights: (runs,), how often each run counts, by rising output; members: bool (runs, slides) in
    the same order; last: the last place of each stretch of equal outputs, where distributions
    step. NaN where empty.
    """
    whole = np.cumsum(weights)
    parts = np.cumsum(weights[:, None] * members, axis=0)
    with np.errstate(invalid="ignore"):
        apart = parts[last] / parts[-1] - (whole[last] / whole[-1])[:, None]
    return np.asarray(np.abs(apart).max(axis=0))


METHOD = Method("pawn", _INDICES, _check, _estimate)
