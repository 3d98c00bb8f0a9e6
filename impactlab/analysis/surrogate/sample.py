"""The runs of a sample as points of the unit cube, split into those to fit and those held out."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from impactlab.analysis.responses import listed
from impactlab.analysis.surrogate.chaos import Array
from impactlab.model.distributions import cumulative, is_distributed

_SHARE = 0.2
"""Of the blocks of runs, to test on."""
_MOST_TESTS = 4000
_BLOCKS = {"sobol": "base_samples", "morris": "trajectories"}
"""Methods whose runs come in blocks of near-copies, and the attribute that says how many."""
_LENGTHS = {"fast": "samples"}
"""Methods whose blocks are curves through the cube, and the attribute that says how long."""


@dataclass(frozen=True)
class Sample:
    """A sample's points, in the order of `run`.

    parameters: names of the varied parameters. groups: the group of each, or again its name.
    unit: (runs, parameters), the probability of each value. block: (runs,), equal for runs that
    differ in few parameters. confidence: of intervals.
    """

    parameters: tuple[str, ...]
    groups: tuple[str, ...]
    unit: Array
    block: NDArray[np.int64]
    seed: int
    confidence: float

    @classmethod
    def of(cls, runs: xr.Dataset) -> Sample:
        """From a sample's runs, sorted by `run`. Raises ValueError where blocks do not fit."""
        names = listed(runs, "varied")
        columns = [cumulative(runs[name].attrs, runs[name].values) for name in names]
        return cls(
            parameters=tuple(names),
            groups=tuple(listed(runs, "groups") if "groups" in runs.attrs else names),
            unit=np.column_stack(columns),
            block=np.arange(runs.sizes["run"]) // _block_length(runs),
            seed=int(runs.attrs["seed"]),
            confidence=float(runs.attrs.get("confidence", 0.95)),
        )

    @property
    def labels(self) -> list[str]:
        """What indices are given for: groups, or parameters, in the order of the study file."""
        return list(dict.fromkeys(self.groups))

    @cached_property
    def held_out(self) -> NDArray[np.bool_]:
        """Which runs no surrogate sees, (runs,): a fifth of the blocks, whole, one at least."""
        blocks = int(self.block[-1]) + 1
        chosen = self._random("held out").permutation(blocks)[: max(1, round(_SHARE * blocks))]
        return np.isin(self.block, chosen)

    @cached_property
    def tests(self) -> NDArray[np.int64]:
        """Positions of the held-out runs, rising; of more than _MOST_TESTS, a draw of as many."""
        found = np.flatnonzero(self.held_out)
        return np.sort(self._random("tests").permutation(found)[:_MOST_TESTS])

    @property
    def fit_seed(self) -> int:
        """Of the choice of runs to fit to."""
        return int(self._random("fit").integers(2**31))

    def _random(self, purpose: str) -> np.random.Generator:
        key = tuple(f"surrogate {purpose}".encode())
        return np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=key))


def is_sample(runs: xr.Dataset) -> bool:
    """Whether runs are draws from distributions that they tell of."""
    return "run" in runs.dims and all(
        name in runs.coords and is_distributed(runs[name].attrs) for name in listed(runs, "varied")
    )


def _block_length(runs: xr.Dataset) -> int:
    method, count = str(runs.attrs.get("method")), runs.sizes["run"]
    if method in _LENGTHS:
        length = int(runs.attrs[_LENGTHS[method]])
    elif method in _BLOCKS:
        length = count // max(int(runs.attrs[_BLOCKS[method]]), 1)
    else:
        length = 1
    if length < 1 or count % length:
        raise ValueError(
            f"the runs of study {runs.attrs.get('study', '?')!r} number {count}, which is no whole "
            f"number of blocks of its method {method}: solve the study again"
        )
    return length
