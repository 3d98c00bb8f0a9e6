"""Regimes: ranges of a response with an empty range between them, and jumps along a grid.

A response that jumps has no typical value: its mean may be a value that no run takes, and shares of
its variance mostly tell how often it jumps.
"""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from impactlab.methods import SAMPLES, independent_runs
from impactlab.methods.morris import Morris
from impactlab.methods.runs import Sample, usable
from impactlab.types import Floats

FEWEST, SHARE = 5, 0.01
"""Smallest number and share of the draws of a regime; fewer are outliers."""
_GAP, _BESIDE = 0.5, 3.5
"""Smallest gap: in standard deviations, and in widths of FEWEST draws on either side of it."""
_CHANCE = 0.05
"""Bound on the probability that a distribution with one mode shows such a gap."""
_JUMP, _STEEP = 0.2, 5.0
"""Smallest jump along a grid: in ranges of the values, and in slopes on either side of it."""


def of_runs(runs: xr.Dataset, response: str) -> Floats:
    """Return the middles of the gaps between the regimes of a response, in SI units, rising.

    There are none where the runs are not a study's sample.
    """
    method = SAMPLES.get(str(runs.attrs.get("method")))
    needed = {"method", "varied"} | ({method.blocks} if method and method.blocks else set())
    if "run" not in runs.dims or not needed <= runs.attrs.keys():
        return np.array([])
    sample = Sample.of(runs)
    return of_sample(sample, usable(sample.runs, response).values[0])


def of_sample(sample: Sample, outputs: Floats) -> Floats:
    """Return the middles of the gaps between the regimes of a response of a sample.

    outputs: (runs,), in the order of `run`. There are none in a Morris sample, whose levels leave
    gaps of their own, nor where it is words that lead from one regime to the other.
    """
    if sample.settings["method"] == Morris.name():
        return np.array([])
    rows = independent_runs(sample)
    values = outputs[rows]
    middles = cuts(values)
    if not middles.size or not sample.words:
        return middles
    columns = np.stack([sample.column(name)[rows] for name in sample.words], axis=1)
    _, groups = np.unique(columns, axis=0, return_inverse=True)
    parts = [values[groups.ravel() == group] for group in range(groups.max() + 1)]
    mixed = [
        any(min((part < middle).sum(), (part > middle).sum()) >= FEWEST for part in parts)
        for middle in middles
    ]
    return middles[mixed]


def cuts(values: Floats) -> Floats:
    """Return the middles of the gaps between the regimes of draws; empty for one regime.

    values: (draws,), independent, in any unit, NaN where missing. Values that repeat, as whole
    numbers do, have no regimes: their number is judged instead (SensitivityVerdict.JUMPS).

    A density with one mode is in a gap no lower than it is on one of the two sides. There, m gaps
    of draws are together narrower than the gap over c/m with a probability of at most
    (1 + c/m)^-m, as of exponential variables; each of the gaps is allowed its part of _CHANCE.

    Over 200 seeds of 64 to 2048 draws, 19 responses with one mode (sums, products, steep rises,
    Ishigami's and Sobol's G function among them) are taken for several regimes in 0.5 % of the
    samples or fewer, and a root beside an atom at zero in 4 % of those of 64 draws and 1 % of
    larger ones. A second regime one width of a regime away from the first is detected in 93 % of
    the samples where it has 26 draws, and one two widths away where it has 13
    (tests/benchmarks/regimes.py).
    """
    ordered = np.sort(values[np.isfinite(values)])
    fewest = max(FEWEST, int(np.ceil(SHARE * ordered.size)))
    if ordered.size < 2 * fewest or _repeat(ordered):
        return np.array([])
    spread = np.clip(ordered, ordered[fewest - 1], ordered[-fewest]).std()
    middles, parts = [], [ordered]
    while parts:
        part = parts.pop()
        gaps = np.diff(part)[fewest - 1 : part.size - fewest]
        for position in np.argsort(-gaps, kind="stable")[: np.count_nonzero(gaps > _GAP * spread)]:
            size = fewest + int(position)  # of the lower regime
            most = min(size, part.size - size) - 1
            near, far = (
                max(part[size - 1] - part[size - 1 - m], part[size + m] - part[size])
                for m in (FEWEST - 1, most)
            )
            chance = (ordered.size / _CHANCE) ** (1 / most) - 1
            if gaps[position] > max(_BESIDE * near, chance * far):
                middles.append(part[size - 1] + gaps[position] / 2)
                parts += [part[:size], part[size:]]
                break
    return np.sort(middles)


def _repeat(values: Floats) -> bool:
    """Return True if most values repeat, beside one value, such as zero, that many may share.

    So do they where nine in ten share it (SensitivityVerdict.MOSTLY_CONSTANT).
    """
    counts = np.unique(values, return_counts=True)[1]
    rest = values.size - counts.max()
    return bool(rest <= 0.1 * values.size or 2 * (counts.size - 1) < rest)


def jumps(places: Floats, values: Floats) -> NDArray[np.int64]:
    """Return the positions after which values jump along an axis.

    places: (points,), rising; values: (points,), NaN where missing. A convex or concave curve is
    nowhere steeper than on both sides, and never jumps.
    """
    finite = np.isfinite(values)
    if np.count_nonzero(finite) < 4 or _repeat(values[finite]):
        return np.array([], int)
    steps = np.abs(np.diff(values))
    slopes = steps / np.diff(places)
    large = np.flatnonzero(steps[1:-1] > _JUMP * np.ptp(values[finite])) + 1
    sides = (
        (slopes[max(position - 2, 0) : position], slopes[position + 1 : position + 3])
        for position in large
    )
    beside = np.array([np.concatenate(pair).max() for pair in sides])
    return large[slopes[large] > _STEEP * beside]
