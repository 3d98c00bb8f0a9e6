"""PAWN: how far the distribution of a response moves when a parameter is held.

The distance is that of Kolmogorov and Smirnov between the runs of a slide, a tenth of the values of
the parameter, and all runs. It needs no density and no variance, so that jumps and skewed responses
are no trouble. In a finite sample it is never zero: noise alone makes the index that shuffled runs
have. Distances are off by no more than noise moves them (the triangle inequality), so the interval
is what shuffles stay below. The slides of a parameter that takes words are the words, and the
median is that over the runs.
"""

import numpy as np
import numpy.typing as npt

from impactlab.methods.hypercube import Hypercube
from impactlab.methods.record import Family, IndexVariable, Indices, Measure, by_width
from impactlab.methods.runs import Sample, dummy_column
from impactlab.types import Floats

SLIDES = 10  # classes of a parameter's values, as in SALib
FEWEST = 10  # runs that a slide needs on average
_2018 = "Pianosi and Wagener (2018), Environ. Model. Softw. 108, 197"
_INTERVAL = "of the index with ten slides; half-width: what shuffled runs stay below"
_VARIABLES = {
    "pawn": IndexVariable(
        "PAWN index, median over the slides", f"{_2018}, eqs. 2 and 3", comment=_INTERVAL
    ),
    "pawn_maximum": IndexVariable(
        "PAWN index, maximum over the slides", f"{_2018}, eqs. 2 and 3", comment=_INTERVAL
    ),
    "dummy_pawn": IndexVariable(
        "PAWN index of a dummy", f"{_2018}, section 2.3", (), comment="the mean of shuffled runs"
    ),
}
FAMILY = Family(
    "pawn_indices",
    "PAWN indices",
    (Measure("pawn", "median"), Measure("pawn_maximum", "largest", optional=True)),
    "Kolmogorov-Smirnov distance (–)",
    "Distance between the distribution of a response and the same with the parameter held in one "
    "part of its range: median and largest over the parts (Pianosi and Wagener).",
)


def _check(sample: Sample) -> None:
    sample.ungrouped()
    if (runs := len(sample.inputs)) < SLIDES * FEWEST:
        raise ValueError(
            f"{sample.study}: {runs} runs are too few for PAWN: take {SLIDES * FEWEST} or more"
        )


def _estimate(outputs: Floats, sample: Sample, response: str) -> dict[str, Floats]:
    categorical = np.array([*(name in sample.words for name in sample.parameters), False])
    inputs = np.column_stack([sample.inputs, dummy_column(sample)])
    order = np.argsort(outputs, kind="stable")
    last = np.flatnonzero(np.diff(outputs[order], append=np.inf))
    members = [
        (column[:, None] == np.unique(column) if of_words else slides(column))[order]
        for column, of_words in zip(inputs.T, categorical, strict=True)
    ]

    def indices(rows: npt.NDArray[np.int64]) -> Floats:
        """Return median and maximum with rows in the place of the outputs, (2, parameters)."""
        pairs = zip(members, categorical, strict=True)
        return np.array([_summary(column[rows], flag, last) for column, flag in pairs]).T

    rng, runs = sample.rng(response), len(outputs)
    shuffles = np.array([indices(rng.permutation(runs)) for _ in range(sample.resamples)])
    (medians, maxima), margins = (
        indices(np.arange(runs)),
        np.quantile(shuffles, sample.confidence, 0),
    )
    dummy = shuffles[:, 0, -1].mean()
    return {
        "pawn": medians[:-1],
        "pawn_interval": margins[0, :-1],
        "pawn_maximum": maxima[:-1],
        "pawn_maximum_interval": margins[1, :-1],
        "dummy_pawn": dummy,
        "dummy_pawn_interval": margins[0, -1] - dummy,
    }


def _summary(
    members: npt.NDArray[np.bool_], categorical: np.bool_, last: npt.NDArray[np.intp]
) -> tuple[float, float]:
    """Return median and maximum of the `distances` of the slides; each word counts by its runs."""
    apart = distances(members, last)
    counted = np.repeat(apart, members.sum(axis=0)) if categorical else apart
    return float(np.nanmedian(counted)), float(np.nanmax(apart))


def slides(column: Floats) -> npt.NDArray[np.bool_]:
    """Return which runs lie in which slide, (runs, slides); SALib omits the largest value."""
    limits = np.quantile(column, np.linspace(0, 1, SLIDES + 1))
    return (column[:, None] >= limits[:-1]) & (column[:, None] < limits[1:])


def distances(members: npt.NDArray[np.bool_], last: npt.NDArray[np.intp]) -> Floats:
    """Return the Kolmogorov-Smirnov distance of each slide from all runs, (slides,).

    members: (runs, slides), by rising output; last: the last place of each stretch of equal
    outputs, where distributions step. NaN where empty.
    """
    parts = np.cumsum(members, axis=0)
    with np.errstate(invalid="ignore"):
        apart = parts[last] / parts[-1] - ((last + 1) / len(members))[:, None]
    return np.asarray(np.abs(apart).max(axis=0))


INDICES = Indices(
    "pawn", _VARIABLES, FAMILY, _check, _estimate, by_width("pawn"), fewest=SLIDES * FEWEST
)


class Pawn(Hypercube):
    """A Latin hypercube for PAWN indices.

    {arguments}

    References
    ----------
    Pianosi and Wagener (2018), Environ. Model. Softw. 108, 197, eqs. 2 and 3.

    {example}
    """

    records = (INDICES,)
    label = "Latin hypercube for PAWN indices"
