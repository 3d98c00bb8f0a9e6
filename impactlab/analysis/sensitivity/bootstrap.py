"""Bootstrap of whatever is a function of means, by matrix products.

The mean over a resample is the mean weighted by how often each row was drawn, so that all
resamples together are one product: counts (resamples, rows) by rows (rows, columns). Efron and
Tibshirani (1993), An Introduction to the Bootstrap, sections 6.2 and 20.2.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np

from impactlab.analysis.sensitivity.sample import Array, Sample

Estimator = Callable[[Array], Mapping[str, Array]]
"""From means (..., columns) to indices (..., *dims)."""
_CELLS = 2_000_000
"""Counts held at a time: 16 MB, and about three times that while they are drawn."""


def counts(rows: int, resamples: int, rng: np.random.Generator) -> Iterator[Array]:
    """How often each row is drawn: (some resamples, rows), of `resamples` in all.

    The draws do not depend on how many are held at a time.
    """
    chunk = max(1, _CELLS // rows)
    for start in range(0, resamples, chunk):
        number = min(chunk, resamples - start)
        drawn = rng.integers(rows, size=(number, rows)) + rows * np.arange(number)[:, None]
        tallied = np.bincount(drawn.ravel(), minlength=number * rows)
        yield tallied.reshape(number, rows).astype(float)


def half_widths(
    columns: Array, estimator: Estimator, sample: Sample, rng: np.random.Generator
) -> dict[str, Array]:
    """Half-widths of the intervals of all that the estimator gives, by `<name>_interval`.

    columns: (rows, columns), resampled by row.
    """
    parts = [
        estimator(tally @ columns / len(columns))
        for tally in counts(len(columns), sample.resamples, rng)
    ]
    return {
        f"{name}_interval": sample.half_width(np.concatenate([part[name] for part in parts]))
        for name in parts[0]
    }
