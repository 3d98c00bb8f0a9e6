"""How a Sobol sample was drawn, read from the attributes of its runs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from impactlab.analysis.responses import listed

CONFIDENCE = 0.95
RESAMPLES = 200
"""Bootstrap resamples: give the width of an interval to 5 % (1/sqrt(2 resamples))."""
_DIMS = {
    "first_order": ("parameter",),
    "total_order": ("parameter",),
    "second_order": ("parameter", "other_parameter"),
}


@dataclass(frozen=True)
class SobolSample:
    """How the sample was drawn and how its indices are to be estimated."""

    parameters: tuple[str, ...]
    second_order: bool
    confidence: float
    resamples: int
    seed: int

    @classmethod
    def of(cls, runs: xr.Dataset) -> SobolSample:
        """From the attributes of a sample study's runs.

        Raises ValueError when the number of runs does not fit the sample that they describe.
        """
        attrs = runs.attrs
        sample = cls(
            parameters=tuple(listed(runs, "varied")),
            second_order=bool(attrs["second_order"]),
            confidence=float(attrs.get("confidence", CONFIDENCE)),
            resamples=int(attrs.get("resamples", RESAMPLES)),
            seed=int(attrs["seed"]),
        )
        expected = int(attrs["base_samples"]) * sample.step
        if runs.sizes["run"] != expected:
            raise ValueError(
                f"the runs of study {attrs.get('study', '?')!r} number {runs.sizes['run']}, but "
                f"{attrs['base_samples']} base samples of {len(sample.parameters)} parameters "
                f"make {expected}: solve the study again"
            )
        return sample

    @property
    def step(self) -> int:
        """Runs for each base sample in Saltelli's scheme."""
        return (2 if self.second_order else 1) * len(self.parameters) + 2

    @property
    def indices(self) -> dict[str, tuple[str, ...]]:
        """Names of the indices with their dimensions beside `response`."""
        return {name: dims for name, dims in _DIMS.items() if self.second_order or len(dims) == 1}

    def seed_of(self, response: str) -> int:
        """A bootstrap seed of the response's own, whatever its place; never zero."""
        state = np.random.SeedSequence(self.seed, spawn_key=tuple(response.encode()))
        return int(state.generate_state(1)[0]) or 1
