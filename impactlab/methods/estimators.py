"""Shared parts of estimators of indices: a dummy parameter, the bootstrap, and the jackknife.

The bootstrap resamples functions of means by matrix products: the mean over a resample is the mean
weighted by how often each row was drawn, so that all resamples together are one product of counts
(resamples, rows) by rows (rows, columns). Efron and Tibshirani (1993), An Introduction to the
Bootstrap, sections 6.2 and 20.2.
"""

from collections.abc import Callable, Iterator, Mapping

import numpy as np
import scipy  # its stats are loaded when first used

from impactlab.methods.runs import Sample
from impactlab.types import Floats


def dummy_column(sample: Sample) -> Floats:
    """Return a Latin hypercube in (0, 1), (runs,): unseen by the model, its indices are noise."""
    runs = sample.size
    return (sample.rng("dummy").permutation(runs) + 0.5) / runs


def apart_from_dummy(name: str, values: Floats, margins: Floats) -> dict[str, Floats]:
    """Return indices and half-widths by variable name; of both, the last is that of the dummy."""
    return {
        name: values[:-1],
        f"{name}_interval": margins[:-1],
        f"dummy_{name}": values[-1],
        f"dummy_{name}_interval": margins[-1],
    }


_CELLS = 2_000_000
"""Number of counts held at a time: 16 MB, and about three times that while they are drawn."""


def counts(rows: int, resamples: int, rng: np.random.Generator) -> Iterator[Floats]:
    """Yield how often each row is drawn: (some resamples, rows), of `resamples` in all."""
    chunk = max(1, _CELLS // rows)  # the draws do not depend on it
    for start in range(0, resamples, chunk):
        number = min(chunk, resamples - start)
        draws = rng.integers(rows, size=(number, rows)) + rows * np.arange(number)[:, None]
        tallied = np.bincount(draws.ravel(), minlength=number * rows)
        yield tallied.reshape(number, rows).astype(float)


def half_widths(
    columns: Floats,
    estimator: Callable[[Floats], Mapping[str, Floats]],
    sample: Sample,
    *purpose: str,
) -> dict[str, Floats]:
    """Return half-widths of intervals of everything the estimator gives, by `<name>_interval`.

    columns: (rows, columns), resampled by row. estimator: from means (..., columns) to indices
    (..., *dims), by name. purpose: of the draws, see `Sample.rng`.
    """
    parts = [
        estimator(tally @ columns / len(columns))
        for tally in counts(len(columns), sample.resamples, sample.rng(*purpose))
    ]
    return {
        f"{name}_interval": sample.half_width(np.concatenate([part[name] for part in parts]))
        for name in parts[0]
    }


def leave_one_out(sums: Floats) -> Floats:
    """Return from sums of replicates, (replicate, ...), that of all, then those without each."""
    total = sums.sum(axis=0, keepdims=True)
    return np.concatenate([total, total - sums])


def half_width(estimates: Floats, confidence: float) -> Floats:
    """Return half-widths of intervals from estimates without one replicate each, (replicate, ...).

    The standard error is that of the jackknife (Efron and Tibshirani 1993, section 11.2), the
    quantile Student's. NaN where an estimate is, and of fewer than two replicates.
    """
    size = len(estimates)
    if size < 2:
        return np.full(estimates.shape[1:], np.nan)
    error = np.sqrt((size - 1) * estimates.var(axis=0))
    return np.asarray(scipy.stats.t.ppf(0.5 + confidence / 2, size - 1) * error)
