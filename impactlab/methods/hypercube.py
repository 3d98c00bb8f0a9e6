"""Latin hypercubes, correlated or not: the sample of every index from given data.

Rank correlations between parameters are those of a Gaussian copula: their distributions stay as
stated. A method has one index; `Latin` has several.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Self

import numpy as np
import scipy  # its stats are loaded when first used
from numpy.typing import NDArray
from pydantic import Field, PlainValidator, StrictStr, TypeAdapter, ValidationInfo, model_validator

from impactlab.methods.record import Indices
from impactlab.methods.sampling import DRAWN_TOGETHER, MOST_RUNS, DrawnTogether
from impactlab.types import Floats
from impactlab.validation.errors import unknown
from impactlab.validation.fields import FileSection, Number, Whole, at_key, names

Places = NDArray[np.uint64]
Correlations = Sequence[tuple[str, str, float]]
"""Two parameters and Spearman's rank correlation of them; pairs that are not listed have 0."""
_LEAST = 1e-8  # smallest eigenvalue of a matrix that counts as positive definite
FEWEST_PLACED = 300
"""Least number that runs placed by a Gaussian process may be limited to."""
FEWEST_OF_WORD = 20
"""Runs per word: bootstrap resamples then practically never hold fewer than two."""
_ARGUMENTS = """Parameters
    ----------
    parameters : mapping of str to distribution or Quantity
        Distribution, or one fixed value, by name of the parameter.
    seed : int, default 1
        Equal seeds give equal runs.
    samples : int
        Number of runs, at least {fewest}.
    correlations : sequence of (str, str, float), optional
        Pairs of parameters with their rank correlation, `[("beam_depth", "velocity", 0.5)]`; other
        pairs are independent.
    until : mapping, optional
        `{{"coefficient_of_variation": 0.1, "runs": 1000}}` solves up to so many runs more, which a
        Gaussian process places, for the probability that the response exceeds its limit."""
_EXAMPLE = """Examples
    --------
    >>> speed, depth = il.Uniform(1, 5), il.Uniform("26 mm", "29 mm")
    >>> sample = il.{method}(samples=128, parameters={{"velocity": speed, "beam_depth": depth}})"""

_Triple = tuple[StrictStr, StrictStr, Annotated[Number, Field(gt=-1, lt=1)]]


class UntilProbability(FileSection):
    """The key `until`: more runs are placed until a probability is known well enough.

    coefficient_of_variation: of the probability that the response exceeds its limit. runs: largest
    number beside the sample's own.
    """

    coefficient_of_variation: Annotated[Number, Field(ge=0.01, le=0.5)]
    runs: Annotated[Whole, Field(ge=FEWEST_PLACED, le=MOST_RUNS)]


def _read_until(data: Any, info: ValidationInfo) -> UntilProbability:
    return UntilProbability.model_validate(data, context=info.context)


def _read_triples(data: Any) -> Correlations:
    if not isinstance(data, list) or not all(isinstance(e, list) and len(e) == 3 for e in data):
        raise ValueError("expected a list of entries such as [beam_depth, beam_width, 0.5]")
    return TypeAdapter(tuple[_Triple, ...]).validate_python(data)


@dataclass(frozen=True, kw_only=True)
class Hypercube(DrawnTogether):
    """A Latin hypercube, the same one whatever indices are estimated from it.

    samples: number of runs. correlations: two varied numbers and their rank correlation (Spearman).

    Raises ValueError where too few runs draw a word to tell the distribution of a response, and
    for correlations that no sample has.
    """

    even = True
    samples: Annotated[Whole, Field(le=MOST_RUNS)]
    correlations: Annotated[Correlations, PlainValidator(_read_triples)] = ()
    until: Annotated[Any, PlainValidator(_read_until)] = None

    def __init_subclass__(cls) -> None:
        """Fill in what the docstrings of the methods share."""
        super().__init_subclass__()
        fewest = max((indices.fewest for indices in cls.records), default=0)
        text = (cls.__doc__ or "").replace("{arguments}", _ARGUMENTS.format(fewest=fewest))
        cls.__doc__ = text.replace("{example}", _EXAMPLE.format(method=cls.__name__))

    @property
    def runs(self) -> int:
        """Number of runs: that of the samples."""
        return self.samples

    @property
    def runs_at_most(self) -> int:
        """The most runs that are solved, with those placed for a probability."""
        return self.samples + (self.until.runs if self.until else 0)

    @model_validator(mode="after")
    def _check_fewest(self) -> Self:
        for indices in self.estimates:
            if self.samples < indices.fewest:
                purpose = f" for {indices.name}" if len(self.estimates) > 1 else ""
                raise at_key("samples", f"must be at least {indices.fewest}{purpose}")
        return self

    @model_validator(mode="after")
    def _check_most(self) -> Self:
        number = len(self.varied)
        for indices in self.estimates:
            if indices.most and number > indices.most:
                reason = f"vary {number}, too many for {indices.name}: vary at most {indices.most}"
                raise at_key("parameters", reason)
        return self

    @model_validator(mode="after")
    def _check_rarest(self) -> Self:
        for name in self.words:
            choice = self.varied[name].arguments()
            weight, word = min(zip(choice["weights"], choice["values"], strict=True))
            if self.samples * weight < FEWEST_OF_WORD:
                reason = (
                    f"gives {word!r} about {self.samples * weight:.0f} of {self.samples:,} runs, "
                    f"and {FEWEST_OF_WORD} are needed: raise samples to "
                    f"{math.ceil(FEWEST_OF_WORD / weight):,}, or leave the word out"
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
        settings, pairs = super().settings, self.correlations
        if pairs:
            settings["correlated"] = [f"{first} {other}" for first, other, _ in pairs]
            settings["rank_correlations"] = [rank for *_, rank in pairs]
        if self.until:
            settings["until_probability"] = self.until.coefficient_of_variation
        return settings

    @property
    def no_surrogate(self) -> str:
        """The reason why no surrogate is fitted to the runs; "" where one is."""
        reason = "no surrogate is fitted over correlated parameters: its terms assume independence"
        return reason if self.correlations else super().no_surrogate

    @property
    def most_runs(self) -> int:
        """The most runs that it draws: correlations order the values of all runs together."""
        return DRAWN_TOGETHER if self.correlations else MOST_RUNS

    def draws(self, start: int = 0, stop: int | None = None) -> Floats:
        """Draw runs start to stop in the unit cube, on (run, varied parameter).

        Beyond DRAWN_TOGETHER runs, the strata are those of a permutation by number, and memory
        holds no other run; smaller samples keep the order that is shuffled as a whole.
        """
        if self.samples <= DRAWN_TOGETHER:
            return super().draws(start, stop)
        stop, size = self.samples if stop is None else stop, len(self.varied)
        placed, *ordered = np.random.SeedSequence(self.seed).spawn(1 + size)
        bits = np.random.PCG64(placed).advance(start * size)
        inside = np.random.Generator(bits).random((stop - start, size))
        runs = np.arange(start, stop, dtype=np.uint64)
        strata = [permuted(runs, self.samples, _round_keys(stream)) for stream in ordered]
        return np.asarray((np.stack(strata, axis=1) + inside) / self.samples)

    def all_draws(self) -> Floats:
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


def permuted(places: Places, size: int, keys: Places) -> Places:
    """Return where a permutation of 0 to size - 1 takes these places, without the others.

    keys: of the rounds of a balanced Feistel network over the next power of four, whose places
    beyond `size` are permuted again until they fall inside: Black and Rogaway (2002), CT-RSA,
    section 3 (recalled, not read).
    """
    half = np.uint64(((size - 1).bit_length() + 1) // 2)
    mask = (np.uint64(1) << half) - np.uint64(1)
    left, right = places >> half, places & mask
    for key in keys:
        left, right = right, left ^ (_mixed(right ^ key) & mask)
    taken = (left << half) | right
    if (outside := taken >= size).any():
        taken[outside] = permuted(taken[outside], size, keys)
    return taken


def _round_keys(stream: np.random.SeedSequence) -> Places:
    return np.asarray(stream.generate_state(6, np.uint64), np.uint64)


def _mixed(words: Places) -> Places:
    """Return 64-bit words that change in half of their bits with any bit: SplitMix64's end."""
    for shift, factor in ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB)):
        words = (words ^ (words >> np.uint64(shift))) * np.uint64(factor)
    return words ^ (words >> np.uint64(31))


def correlation_matrix(names: Sequence[str], correlations: Correlations) -> Floats:
    """Return the linear correlations of the normal variables, (names, names).

    They are 2 sin(π ρ / 6) of the rank correlations ρ: Pearson (1907), as in Kruskal (1958), J. Am.
    Stat. Assoc. 53, 814 (recalled, not read). Pairs with other names are left out.
    """
    matrix, place = np.eye(len(names)), {name: i for i, name in enumerate(names)}
    for first, second, rank in correlations:
        if first in place and second in place:
            linear = 2 * np.sin(np.pi * rank / 6)
            matrix[place[first], place[second]] = matrix[place[second], place[first]] = linear
    return matrix


def contradicting(names: Sequence[str], correlations: Correlations) -> list[str]:
    """Return the fewest of the names whose correlations exclude each other; none if all can be."""

    def possible(subset: Sequence[str]) -> bool:
        smallest = np.linalg.eigvalsh(correlation_matrix(subset, correlations)).min(initial=1)
        return bool(smallest > _LEAST)

    clashing = [] if possible(names) else list(names)
    for name in clashing.copy():
        rest = [member for member in clashing if member != name]
        clashing = clashing if possible(rest) else rest
    return clashing


def correlated(unit: Floats, linear: Floats) -> Floats:
    """Return the sample with each column in another order, (runs, parameters).

    unit: independent draws in the unit cube, so even as they are; linear: correlation_matrix. The
    ranks are those of the normal variables with these correlations: Stein (1987), Technometrics 29,
    143, section 4 (recalled, not read). A column without partners keeps its order.
    """
    normal = scipy.stats.norm.ppf(unit) @ np.linalg.cholesky(linear).T
    ranks = normal.argsort(axis=0, kind="stable").argsort(axis=0)
    return np.asarray(np.take_along_axis(np.sort(unit, axis=0), ranks, axis=0))


def _choices() -> dict[str, Indices]:
    """Return the indices that a Latin hypercube can have, by name."""
    return {record.name: record for kind in Hypercube.__subclasses__() for record in kind.records}


def _read_names(data: Any, info: ValidationInfo) -> tuple[str, ...]:
    if data == "all":
        data = [name for name, record in _choices().items() if not record.most | record.of_limits]
    reader: Any = names("index", _choices()).func
    chosen: tuple[str, ...] = reader(data, info)
    return chosen


@dataclass(frozen=True, kw_only=True)
class Latin(Hypercube):
    """A Latin hypercube for several indices, all from the same runs.

    Parameters
    ----------
    parameters : mapping of str to distribution or Quantity
        Distribution, or one fixed value, by name of the parameter.
    seed : int, default 1
        Equal seeds give equal runs.
    samples : int
        Number of runs, at least 64, with "pawn" 100, with "shapley" 128.
    correlations : sequence of (str, str, float), optional
        Pairs of parameters with their rank correlation, `[("beam_depth", "velocity", 0.5)]`; other
        pairs are independent.
    until : mapping, optional
        As of `Pawn`: runs placed for the probability that the response exceeds its limit.
    indices : sequence of str or "all"
        "delta", "hsic", "pawn", "rbd_fast", "regression", "shapley", "target_hsic"; the first one
        ranks the parameters; "all" stands for those of any number of parameters and without limits.

    Examples
    --------
    >>> speed, depth = il.Uniform(1, 5), il.Uniform("26 mm", "29 mm")
    >>> sample = il.Latin(
    ...     samples=128, indices=["delta", "pawn"],
    ...     parameters={"velocity": speed, "beam_depth": depth})
    """

    label = "Latin hypercube"
    indices: Annotated[Sequence[str], PlainValidator(_read_names)]

    @property
    def estimates(self) -> tuple[Indices, ...]:
        """Indices that the analysis estimates."""
        return tuple(_choices()[name] for name in self.indices)

    @property
    def settings(self) -> dict[str, Any]:
        """The attributes of a design that describe its draws."""
        return super().settings | {"indices": list(self.indices)}
