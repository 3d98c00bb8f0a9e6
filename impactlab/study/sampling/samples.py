"""The samples: sections `sampling` with a method that draws the runs, and their draws."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Any, Literal, Self

import numpy as np
import scipy  # its stats are loaded when first used
from pydantic import AfterValidator, BeforeValidator, Field, StrictBool, StrictStr, model_validator

from impactlab.model.distributions import contradicting, correlated, correlation_matrix
from impactlab.study.errors import unknown
from impactlab.study.sampling.sections import MOST_RUNS, Grouped, Sample
from impactlab.study.schema.section import Names, Number, Section, Whole, at_key, requires
from impactlab.types import Floats

_FEWEST_TO_GROW = 64
"""Base samples from which on intervals are good enough to decide on growth."""
REPLICATES = 8
"""Independent scrambles of a Sobol sample: fewer widen Student's t, more make each one poorer."""
_FEWEST_OF_WORD = 20
"""Runs per word: bootstrap resamples then practically never hold fewer than two."""
_CURVES = 4
"""Curves of FAST per parameter: their differences tell the error of its indices."""
_EVEN = "must be even: the steps would favour some levels otherwise"


class Until(Section):
    """The key `until`: the sample is doubled until its intervals are narrow enough.

    interval: largest half-width of the interval of a first or total-order index. runs: largest
    number of runs. responses: those whose indices count; None: all.
    """

    interval: Annotated[Number, Field(ge=0.001, le=0.5)]
    runs: Annotated[Whole, Field(ge=1, le=MOST_RUNS)]
    responses: Names | None = None


def _power_of_two(value: int) -> int:
    if value & (value - 1):
        below = 1 << (value.bit_length() - 1)
        raise ValueError(f"must be a power of two, such as {below} or {2 * below}")
    return value


def saltelli(groups: Sequence[str], base_samples: int, second_order: bool, seed: int) -> Floats:
    """Draw Saltelli's sample in the unit cube, (runs, parameter), base sample by base sample.

    groups: the group of each parameter. The runs of a base sample are the points A, A with the
    columns of each group from B, with second_order B with the columns of each group from A, and B.

    A and B are the halves of the points of one Sobol sequence, whose dimensions may depend on each
    other four at a time (such as i and j of A and of B), so that the outputs at A and B correlate
    however many points there are. Base sample k is therefore point k // REPLICATES of replicate
    k % REPLICATES: a sequence with a scramble of its own, which makes such a correlation as often
    positive as negative, and an order of its own of the dimensions. The spread of the replicates
    tells the error (L'Ecuyer et al. 2023, Proc. Winter Simulation Conf.), and the first base
    samples are the smaller sample.
    """
    count, dimensions = min(REPLICATES, base_samples), 2 * len(groups)
    points = np.empty((base_samples, dimensions))
    for place, stream in enumerate(np.random.SeedSequence(seed).spawn(count)):
        rng = np.random.default_rng(stream)
        order = rng.permutation(dimensions)
        sequence = scipy.stats.qmc.Sobol(dimensions, rng=rng)
        points[place::count] = sequence.random(base_samples // count)[:, order]
    names = list(dict.fromkeys(groups))
    swapped = np.array([[group == name for group in groups] for name in names])
    every_group = np.ones((1, len(groups)), bool)
    from_b = np.concatenate([~every_group, swapped, *[~swapped] * second_order, every_group])
    a, b = points[:, None, : len(groups)], points[:, None, len(groups) :]
    return np.where(from_b, b, a).reshape(-1, len(groups))


class Sobol(Grouped):
    """Saltelli's sample.

    base_samples: N, a power of two. second_order: whether second-order indices are wanted; they
    take N (2 G + 2) runs of G parameters or groups instead of N (G + 2). until: how far the
    sample is doubled; None: it is not.

    Raises ValueError when `until` allows fewer runs than the first sample has, or when that
    sample is too small for its intervals to be trusted.
    """

    method: Literal["sobol"]
    base_samples: Annotated[Whole, Field(ge=4, le=MOST_RUNS), AfterValidator(_power_of_two)]
    second_order: StrictBool = True
    until: Until | None = None

    @property
    def pairs(self) -> bool:
        """True where second-order indices are drawn: a single parameter has none."""
        return self.second_order and self.group_count > 1

    @property
    def runs(self) -> int:
        """Saltelli's number of runs."""
        return self.base_samples * ((2 if self.pairs else 1) * self.group_count + 2)

    @model_validator(mode="after")
    def _check_until(self) -> Self:
        if self.until and self.base_samples < _FEWEST_TO_GROW:
            reason = "with until: the intervals of fewer cannot be trusted"
            raise at_key("base_samples", f"must be at least {_FEWEST_TO_GROW} {reason}")
        if self.until and self.until.runs < self.runs:
            raise at_key("until.runs", f"must be at least the first sample's {self.runs:,} runs")
        return self

    @property
    def settings(self) -> dict[str, Any]:
        """The attributes of a design that describe its draws."""
        settings = super().settings | {"second_order": int(self.pairs), "replicates": REPLICATES}
        if not (until := self.until):
            return settings
        limits = {"until_interval": until.interval, "until_runs": until.runs}
        responses = {"until_responses": list(until.responses)} if until.responses else {}
        return settings | limits | responses

    def draws(self) -> Floats:
        """Draw base samples one after the other, see `saltelli`."""
        groups = list(self.group_of.values())
        return saltelli(groups, self.base_samples, self.pairs, self.seed)


class Morris(Grouped):
    """Morris' trajectories, for elementary effects.

    They lie on a grid of levels; along each, every parameter (or group) steps once. trajectories:
    how many are drawn. levels: number of grid levels, evenly spaced in probability, ends included.

    Raises ValueError for a distribution without ends.
    """

    method: Literal["morris"]
    trajectories: Annotated[Whole, Field(ge=2, le=1_000_000)]
    levels: Annotated[
        Whole, Field(ge=2, le=100), requires(lambda levels: levels % 2 == 0, _EVEN)
    ] = 4

    @property
    def runs(self) -> int:
        """Number of runs: per trajectory a start, and one step per parameter or group."""
        return self.trajectories * (self.group_count + 1)

    @model_validator(mode="after")
    def _check_ends(self) -> Self:
        if endless := [name for name, entry in self.varied.items() if not entry.bounds()]:
            reason = (
                "has no ends, where method morris has its outer levels: "
                "use truncated_normal, or another with low and high"
            )
            raise at_key(f"parameters.{endless[0]}.distribution", reason)
        return self

    def draws(self) -> Floats:
        """Draw trajectories of levels, 0 and 1 included: a start, and one step per factor."""
        (rng,) = np.random.default_rng(self.seed).spawn(1)  # as in SALib: same bits
        groups = list(self.group_of.values())
        names = list(dict.fromkeys(groups))
        group_numbers = [names.index(group) for group in groups]
        step = self.levels / (2.0 * (self.levels - 1))
        lower_levels = np.linspace(0, 1 - step, self.levels // 2)
        points = np.arange(len(names) + 1)[:, None]
        trajectories = np.empty((self.trajectories, len(names) + 1, len(groups)))
        for trajectory in trajectories:
            order = rng.permutation(len(names))[group_numbers]
            ascending = rng.choice([False, True], len(groups))
            starts = rng.choice(lower_levels, len(groups))
            trajectory[:] = starts + step * ((points > order) == ascending)
        return trajectories.reshape(-1, len(groups))


class Fast(Sample):
    """Search curves of the extended Fourier amplitude sensitivity test (FAST).

    There are four per parameter, and four for a dummy parameter, whose indices are noise. samples:
    the most runs of a parameter's curves; whole periods need up to 8 (2 M + 1) fewer. harmonics: M,
    the multiples of a frequency that are kept apart from other parameters. Raises ValueError where
    the parameters cannot all have frequencies of their own.
    """

    method: Literal["fast"]
    samples: Annotated[Whole, Field(ge=5, le=MOST_RUNS)]
    harmonics: Annotated[Whole, Field(ge=4, le=100)] = 4

    @property
    def frequency(self) -> int:
        """Frequency of a parameter on its own curves: odd, to share few factors with others."""
        largest = self.samples // (_CURVES * (2 * self.harmonics + 1))
        return largest - 1 + largest % 2

    @property
    def points(self) -> int:
        """Points of a curve: so many that the harmonics beyond the last fold onto harmonics."""
        return (2 * self.harmonics + 1) * self.frequency

    @property
    def curves(self) -> int:
        """Number of curves: those of each parameter, and of the dummy."""
        return _CURVES * (len(self.varied) + 1)

    @property
    def runs(self) -> int:
        """Number of runs: the points of all curves."""
        return self.curves * self.points

    @model_validator(mode="after")
    def _check_resolution(self) -> Self:
        # one frequency more than there are others: with fewer, intervals miss too often
        width = 2 * self.harmonics
        least = _CURVES * (width + 1) * (width * (len(self.varied) + 1) + 1)
        if self.samples < least:
            size = f"{self.harmonics} harmonics of {len(self.varied)} parameters"
            raise at_key("samples", f"must be at least {least:,} for {size}")
        return self

    @property
    def settings(self) -> dict[str, Any]:
        """The attributes of a design that describe its draws."""
        return super().settings | {"curves": self.curves, "frequency": self.frequency}

    def draws(self) -> Floats:
        """Draw the curves of one parameter after the other, last those of the dummy.

        Along a curve, the others have distinct frequencies up to 1/(2 M) of the parameter's own;
        frequencies and phases are drawn anew for each curve (Saltelli et al. 1999, eq. 20).
        """
        rng, size = np.random.default_rng(self.seed), len(self.varied)
        angles = 2 * np.pi * np.arange(self.points)[:, None] / self.points
        curves = np.empty((size + 1, _CURVES, self.points, size))
        for parameter, curve in np.ndindex(curves.shape[:2]):
            frequencies = 1 + rng.choice(
                self.frequency // (2 * self.harmonics), size, replace=False
            )
            if parameter < size:
                frequencies[parameter] = self.frequency
            waves = np.sin(frequencies * angles + rng.uniform(0, 2 * np.pi, size))
            curves[parameter, curve] = 0.5 + np.arcsin(waves) / np.pi
        return curves.reshape(-1, size)


def _check_triples(data: Any) -> Any:
    if not isinstance(data, list) or not all(isinstance(e, list) and len(e) == 3 for e in data):
        raise ValueError("expected a list of entries such as [beam_depth, beam_width, 0.5]")
    return data


class Latin(Sample):
    """Latin hypercube: the one sample of delta, PAWN and regression.

    samples: number of runs. correlations: two varied numbers and their rank correlation (Spearman);
    a Gaussian copula joins them.

    Raises ValueError where too few runs draw a word to tell the distribution of a response, and
    for correlations that no sample has.
    """

    method: Literal["delta", "pawn", "regression"]
    samples: Annotated[Whole, Field(ge=64, le=MOST_RUNS)]
    correlations: Annotated[
        tuple[tuple[StrictStr, StrictStr, Annotated[Number, Field(gt=-1, lt=1)]], ...],
        BeforeValidator(_check_triples),
    ] = ()

    @property
    def runs(self) -> int:
        """Number of runs: that of the samples."""
        return self.samples

    @model_validator(mode="after")
    def _check_rarest(self) -> Self:
        for name in self.words:
            choice = self.varied[name].arguments()
            weight, word = min(zip(choice["weights"], choice["values"], strict=True))
            if self.samples * weight < _FEWEST_OF_WORD:
                reason = (
                    f"gives {word!r} about {self.samples * weight:.0f} of {self.samples:,} runs, "
                    f"and {_FEWEST_OF_WORD} are needed: raise samples to "
                    f"{math.ceil(_FEWEST_OF_WORD / weight):,}, or leave the word out"
                )
                raise at_key(f"parameters.{name}", reason)
        return self

    @model_validator(mode="after")
    def _check_correlations(self) -> Self:
        seen: set[frozenset[str]] = set()
        for index, (*pair, _) in enumerate(self.correlations):
            for end, name in enumerate(pair):
                if name in self.fixed:
                    reason = "is fixed, so nothing correlates with it: take the entry out"
                elif name in self.words:
                    reason = "takes words, which have no order to correlate: take the entry out"
                elif name not in self.varied:
                    reason = unknown("varied parameter", name, self.varied)
                elif end and name == pair[0]:
                    reason = "is named twice: name two different parameters"
                else:
                    continue
                raise at_key(f"correlations.{index}.{end}", reason)
            if frozenset(pair) in seen:
                raise at_key(f"correlations.{index}", "is given before: state each pair once")
            seen.add(frozenset(pair))
        if wrong := contradicting(list(self.varied), self.correlations):
            inside = (entry for entry in self.correlations if {*entry[:2]} <= {*wrong})
            listed = ", ".join(f"{first} with {other} {rank:g}" for first, other, rank in inside)
            reason = (
                f"contradict each other ({listed}; pairs that are not listed have 0): the matrix "
                f"of {', '.join(wrong)} is not positive definite: bring them closer to 0, or state "
                "the pairs left out"
            )
            raise at_key("correlations", reason)
        return self

    @property
    def settings(self) -> dict[str, Any]:
        """The attributes of a design that describe its draws."""
        if not (pairs := self.correlations):
            return super().settings
        names = {"correlated": [f"{first} {other}" for first, other, _ in pairs]}
        return super().settings | names | {"rank_correlations": [rank for *_, rank in pairs]}

    @property
    def no_surrogate(self) -> str:
        """The reason why no surrogate is fitted to the runs; "" where one is."""
        reason = "no surrogate is fitted over correlated parameters: its terms assume independence"
        return reason if self.correlations else super().no_surrogate

    def draws(self) -> Floats:
        """Draw one value in each of equal strata of every parameter, whatever the method.

        Correlations change the order of these values alone.
        """
        (rng,) = np.random.default_rng(self.seed).spawn(1)  # as in SALib: same bits
        edges = np.arange(self.samples + 1)[:, None] * (1.0 / self.samples)
        unit = rng.uniform(edges[:-1], edges[1:], (self.samples, len(self.varied)))
        for column in unit.T:
            rng.shuffle(column)
        if not self.correlations:
            return unit
        return correlated(unit, correlation_matrix(list(self.varied), self.correlations))


class Pawn(Latin):
    """Latin hypercube with ten runs or more in each of PAWN's ten slides."""

    method: Literal["pawn"]
    samples: Annotated[Whole, Field(ge=100, le=MOST_RUNS)]
