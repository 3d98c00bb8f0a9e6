"""A sample under analysis: its inputs, and the settings of what is found from it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy  # its stats are loaded when first used
import xarray as xr

from impactlab.analysis.responses import listed
from impactlab.types import Floats


@dataclass(frozen=True)
class Sample:
    """A sample, and the settings of its indices.

    groups: the group of each parameter; empty where each stands for itself. inputs: (runs,
    parameter), in SI units and in the order of the runs. settings: the attributes of the runs.
    """

    parameters: tuple[str, ...]
    groups: tuple[str, ...]
    inputs: Floats
    settings: Mapping[Any, Any]

    @classmethod
    def of(cls, runs: xr.Dataset) -> Sample:
        """Return the sample of runs, from their coordinates and attributes."""
        names, ordered = listed(runs, "varied"), runs.sortby("run")
        return cls(
            parameters=tuple(names),
            groups=tuple(listed(runs, "groups")) if "groups" in runs.attrs else (),
            inputs=np.stack([np.asarray(ordered[name].values, float) for name in names], axis=1),
            settings=runs.attrs,
        )

    @property
    def memberships(self) -> tuple[str, ...]:
        """The factor of each parameter: its group, or its own name."""
        return self.groups or self.parameters

    @property
    def factors(self) -> tuple[str, ...]:
        """Names of the indices: groups in order of appearance, or parameters."""
        return tuple(dict.fromkeys(self.memberships))

    @property
    def confidence(self) -> float:
        """Confidence level of the intervals, in (0, 1)."""
        return float(self.settings.get("confidence", 0.95))

    @property
    def resamples(self) -> int:
        """Number of bootstrap resamples: 200 give the width of an interval to 5 %."""
        return int(self.settings.get("resamples", 200))

    @property
    def study(self) -> str:
        """The study's name, for messages."""
        return f"the study {str(self.settings.get('study', '?'))!r}"

    def number(self, setting: str) -> int:
        """Return a whole number that the method needs. Raises ValueError where it is absent."""
        if setting not in self.settings:
            raise ValueError(
                f"the runs of {self.study} have no attribute {setting}: solve the study again"
            )
        return int(self.settings[setting])

    def expect(self, runs: int, words: str) -> None:
        """Raise ValueError unless the sample has this number of runs; words: where it is from."""
        if len(self.inputs) != runs:
            raise ValueError(
                f"{self.study} has {len(self.inputs)} runs, but {words} make {runs}: solve it again"
            )

    def ungrouped(self) -> None:
        """Raise ValueError where groups are stated for a method that has none."""
        if self.groups:
            raise ValueError(
                f"{self.study}: the method {self.settings['method']!r} has no groups: remove them, "
                "or use sobol or morris"
            )

    def rng(self, *purpose: str) -> np.random.Generator:
        """Return the random stream of a purpose, such as a response, independent of all others."""
        key = tuple("\0".join(purpose).encode())
        return np.random.default_rng(np.random.SeedSequence(self.number("seed"), spawn_key=key))

    def half_width(self, replicates: Floats) -> Floats:
        """Return half-widths of intervals from replicates (resamples, ...), NaN where one is."""
        quantile = float(scipy.stats.norm.ppf(0.5 + self.confidence / 2))
        return np.asarray(quantile * replicates.std(axis=0, ddof=1))
