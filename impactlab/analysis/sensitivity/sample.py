"""How a sample was drawn, read from the attributes of its runs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr
from scipy.stats import norm

from impactlab.analysis.responses import listed

Array = npt.NDArray[np.float64]

CONFIDENCE = 0.95
RESAMPLES = 200
"""Bootstrap resamples: give the width of an interval to 5 % (1/sqrt(2 resamples))."""
POLICIES = ("fail", "impute")


@dataclass(frozen=True)
class Sample:
    """How the sample was drawn and how its indices are to be estimated.

    groups: the group of each parameter; empty where each stands for itself. inputs: (runs,
    parameter), in SI units and in the order of the runs. settings: the attributes of the runs.
    """

    parameters: tuple[str, ...]
    groups: tuple[str, ...]
    inputs: Array
    settings: Mapping[Any, Any]

    @classmethod
    def of(cls, runs: xr.Dataset) -> Sample:
        """From the coordinates and attributes of a sample study's runs."""
        names = listed(runs, "varied")
        ordered = runs.sortby("run")
        return cls(
            parameters=tuple(names),
            groups=tuple(listed(runs, "groups")) if "groups" in runs.attrs else (),
            inputs=np.stack([np.asarray(ordered[name].values, float) for name in names], axis=1),
            settings=runs.attrs,
        )

    @property
    def factors(self) -> tuple[str, ...]:
        """What has indices: the groups in order of appearance, or the parameters."""
        return tuple(dict.fromkeys(self.groups or self.parameters))

    @property
    def confidence(self) -> float:
        """Of the intervals, in (0, 1)."""
        return float(self.settings.get("confidence", CONFIDENCE))

    @property
    def resamples(self) -> int:
        """Number of bootstrap resamples."""
        return int(self.settings.get("resamples", RESAMPLES))

    @property
    def policy(self) -> str:
        """What to do about failed runs. Raises ValueError for a word that has no meaning."""
        policy = str(self.settings.get("failed_runs", POLICIES[0]))
        if policy not in POLICIES:
            raise ValueError(f"{self.study}: failed_runs = {policy!r}, but may be fail or impute")
        return policy

    @property
    def study(self) -> str:
        """The study's name, for messages."""
        return f"the study {str(self.settings.get('study', '?'))!r}"

    def number(self, setting: str) -> int:
        """A whole number that the method needs. Raises ValueError where it is absent."""
        if setting not in self.settings:
            raise ValueError(
                f"the runs of {self.study} do not say their {setting}: solve the study again"
            )
        return int(self.settings[setting])

    def expect(self, runs: int, words: str) -> None:
        """Raises ValueError when the number of runs is not that of the sample; words: why so."""
        if len(self.inputs) != runs:
            raise ValueError(
                f"the runs of {self.study} number {len(self.inputs)}, but {words} make {runs}: "
                "solve the study again"
            )

    def ungrouped(self) -> None:
        """Raises ValueError where groups are stated for a method that has none."""
        if self.groups:
            raise ValueError(
                f"{self.study}: the method {self.settings['method']!r} has no groups: take them "
                "out, or use sobol or morris"
            )

    def rng(self, *purpose: str) -> np.random.Generator:
        """A stream of its own for each purpose, such as a response, whatever the order."""
        key = tuple("\0".join(purpose).encode())
        seed = self.number("seed")
        return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=key))

    def half_width(self, replicates: Array) -> Array:
        """Of the interval, from bootstrap replicates (resamples, ...) by their deviation.

        NaN where a replicate is: a resample without variance has no index.
        """
        quantile = float(norm.ppf(0.5 + self.confidence / 2))
        return np.asarray(quantile * replicates.std(axis=0, ddof=1))
