"""Base classes of methods of sampling: sections `sampling` of a study, and objects in Python."""

import logging
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property, partial
from typing import Annotated, Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import (
    Field,
    PlainValidator,
    TypeAdapter,
    ValidationInfo,
    field_validator,
    model_validator,
)

from impactlab.methods.distributions import (
    CHOICE,
    DISTRIBUTIONS,
    ENTRIES,
    Choice,
    Fixed,
    Integers,
)
from impactlab.methods.entries import Distribution, Entry
from impactlab.methods.record import Indices
from impactlab.methods.runs import Sample
from impactlab.methods.scipy_distributions import is_frozen, unfrozen
from impactlab.model.parameters import PROFILE_FIXED, SPHERES_FIXED, Parameter, Value
from impactlab.types import Floats
from impactlab.validation.errors import unknown
from impactlab.validation.fields import LABEL, Names, Stated, Whole, at_key, by_name, name_at

MOST_RUNS = 2_000_000_000
DRAWN_TOGETHER = 10_000_000
"""Most runs of a sample that is drawn as a whole, also where a block of it is asked for."""
_SLOWLY_DRAWN = 100_000  # runs that take a second or more
log = logging.getLogger(__name__)

_EDGE = 2.0**-31
"""Half a step of scipy's 30-bit Sobol sequence: keeps draws off 0 and 1, where quantiles may be
infinite."""


def _refuse_list(parameter: Parameter, data: Any, info: ValidationInfo) -> Any:
    """Raise ValueError: a list, as the profile of a section, is no factor."""
    raise ValueError(SPHERES_FIXED if parameter.name == "further_spheres" else PROFILE_FIXED)


@dataclass(frozen=True, kw_only=True)
class Sampling(Stated):
    """The section `sampling`: the parameters, in the order of the file.

    label: the sample in words. no_distribution: why its runs do not represent the distribution of a
    response; "" where they do.
    """

    _name_key = "method"
    label: ClassVar[str]
    no_distribution: ClassVar[str] = ""
    parameters: Mapping[str, Any]

    @property
    def method(self) -> str:
        """Name of the method in study files."""
        return self.name()

    @staticmethod
    @abstractmethod
    def read_entry(parameter: Parameter, data: Any, info: ValidationInfo) -> Any:
        """Read one parameter's entry. Raises ValueError for a wrong one."""

    @property
    @abstractmethod
    def runs(self) -> int:
        """Number of runs of the study."""

    @property
    def runs_at_most(self) -> int:
        """The most runs that are solved, where `until` decides."""
        return self.runs

    @property
    def varied(self) -> Mapping[str, Any]:
        """Entries of the parameters that differ between runs: no sampler sees the others."""
        return {
            name: entry for name, entry in self.parameters.items() if not isinstance(entry, Fixed)
        }

    @property
    def fixed(self) -> dict[str, Value]:
        """Values of the parameters that are listed with a single value."""
        entries = self.parameters.items()
        return {name: entry.value for name, entry in entries if isinstance(entry, Fixed)}

    @property
    def words(self) -> list[str]:
        """Names of the parameters that are drawn among words."""
        return [name for name, entry in self.parameters.items() if isinstance(entry, Choice)]

    @property
    def discrete(self) -> list[str]:
        """Names of the parameters that are drawn among few values."""
        entries = self.parameters.items()
        return [n for n, entry in entries if isinstance(entry, Distribution) and entry.is_discrete]

    @property
    def no_surrogate(self) -> str:
        """The reason why no surrogate is fitted to the runs; "" where one is."""
        if self.discrete:
            return "no surrogate is fitted over steps or whole numbers"
        return "no surrogate is fitted over words, which have no order" if self.words else ""

    @property
    def most_runs(self) -> int:
        """The most runs that it draws."""
        return MOST_RUNS

    @abstractmethod
    def bounds(self) -> dict[str, tuple[Value, ...]]:
        """Return the least and greatest value of each bounded parameter, or all of its words."""

    @abstractmethod
    def columns(self, start: int = 0, stop: int | None = None) -> dict[str, np.ndarray[Any, Any]]:
        """Return the values of each varied parameter in runs start to stop, in SI units, or words.

        They are the same in any block of runs.
        """

    @field_validator("parameters", mode="plain")
    @classmethod
    def _read_parameters(cls, data: Any, info: ValidationInfo) -> dict[str, Any]:
        types = {
            name: Annotated[
                Any,
                PlainValidator(
                    partial(_refuse_list, parameter)
                    if parameter.any_word and parameter.path
                    else partial(cls.read_entry, parameter)
                ),
            ]
            for name, parameter in info.context["parameters"].items()  # type: ignore[index]
        }
        return by_name("Parameters", types, data, info)

    @model_validator(mode="after")
    def _check_counts(self) -> Self:
        if not self.varied:
            count = " (fixed ones do not count)" if self.fixed else ""
            reason = f"too few: method {self.method} varies 1 or more{count}"
            raise at_key("parameters", reason)
        if self.runs > self.most_runs:
            whole = ", for they are drawn together" if self.most_runs == DRAWN_TOGETHER else ""
            most = f"{self.most_runs:,} or fewer{whole}"
            raise ValueError(f"makes {self.runs:,} runs: reduce them to {most}")
        return self


@dataclass(frozen=True, kw_only=True)
class RandomSample(Sampling):
    """Draws of one parameter or more.

    seed: equal seeds give equal draws; 0 is a seed like any other. parameters: a distribution, a
    choice of words or one fixed value each. records: the indices that it has by itself. even: True
    where draws spread more evenly than random ones. allows_ties: True
    where its indices hold although many runs share a value, as steps do. blocks: setting
    with the number of blocks of runs that are near-copies of each other; "" where all runs are
    draws of their own.

    Raises ValueError for a choice of words where an index needs an order of the values.
    """

    records: ClassVar[tuple[Indices, ...]] = ()
    even: ClassVar[bool] = False
    allows_ties: ClassVar[bool] = False
    blocks: ClassVar[str] = ""
    seed: Annotated[Whole, Field(ge=0, le=2**32 - 1)] = 1

    @property
    def estimates(self) -> tuple[Indices, ...]:
        """Indices that the analysis estimates."""
        return self.records

    @staticmethod
    def independent(sample: Sample) -> NDArray[np.int64]:
        """Return the numbers of the runs that are draws of their own."""
        return np.arange(sample.size)

    @staticmethod
    def near_runs(sample: Sample, length: int) -> int:
        """Return how many runs in a row are alike, in blocks of a length."""
        return length

    def stated(self) -> dict[str, Any]:
        """Return the section as a study file has it, with single values as fixed parameters.

        Returns
        -------
        dict
            Keys and values of the section.
        """
        entries: Any = self.parameters
        if isinstance(entries, Mapping) and any(map(is_frozen, entries.values())):
            entries = {
                name: unfrozen(name, item) if is_frozen(item) else item
                for name, item in entries.items()
            }
            return replace(self, parameters=entries).stated()
        section = super().stated()
        parameters = section.pop("parameters")
        if isinstance(parameters, Mapping):
            parameters = {
                name: item if isinstance(item, dict) else Fixed(item).stated()
                for name, item in parameters.items()
            }
        return section | {"parameters": parameters}

    @staticmethod
    def read_entry(parameter: Parameter, data: Any, info: ValidationInfo) -> Entry:
        """Read a distribution within the model's limits, a choice of words, or a fixed value."""
        kind = data.get("distribution") if isinstance(data, dict) else None
        if parameter.choices and kind not in (CHOICE, "fixed"):
            example = ", ".join(parameter.choices[:2])
            raise ValueError(
                f"takes words: write {{distribution: choice, values: [{example}]}}, or "
                "{distribution: fixed, value: ...}"
            )
        if parameter.is_integer and kind not in (Integers.name(), "fixed"):
            raise ValueError(
                "is a whole number: write {distribution: integers, low: ..., high: ...}, or "
                "{distribution: fixed, value: ...}, or vary it in a study with method: grid"
            )
        if kind == CHOICE and not (parameter.choices or parameter.any_word):
            raise at_key(
                "distribution",
                f"is for words, and this is a number: use {', '.join(DISTRIBUTIONS)}",
            )
        name = name_at("distribution", ENTRIES, data)
        context = {**(info.context or {}), "parameter": parameter}
        return ENTRIES[name].read(data, context)

    @model_validator(mode="after")
    def _check_discrete(self) -> Self:
        if self.discrete and not self.allows_ties:
            reason = (
                "draws from a list of values, which method sobol alone does: take it, or a grid"
            )
            raise at_key(f"parameters.{self.discrete[0]}.distribution", reason)
        return self

    @model_validator(mode="after")
    def _check_words(self) -> Self:
        for indices in self.estimates if self.words else ():
            if indices.order:
                method = self.method
                if method != indices.name:
                    method += f" with the indices {indices.name}"
                reason = (
                    f"cannot be drawn by method {method}, which {indices.order}, and words have no "
                    "order: use method sobol, delta or pawn, or fix it ({distribution: fixed, "
                    "value: ...})"
                )
                raise at_key(f"parameters.{self.words[0]}.distribution", reason)
        return self

    @property
    def settings(self) -> dict[str, Any]:
        """The attributes of a design that describe its draws: the other keys of the section."""
        values = {entry.name: getattr(self, entry.name) for entry in fields(self)}
        return {name: int(value) for name, value in values.items() if isinstance(value, int)}

    def bounds(self) -> dict[str, tuple[Value, ...]]:
        """Return low and high of the bounded distributions, all words, and the fixed values."""
        ends = {
            name: tuple(entry.values)
            if isinstance(entry, Choice)
            else tuple(entry.bounds().values())
            for name, entry in self.varied.items()
        } | {name: (value,) for name, value in self.fixed.items()}
        return {name: values for name, values in ends.items() if values}

    @property
    def group_of(self) -> dict[str, str]:
        """The group of each varied parameter, in their order; empty where there are no groups."""
        return {}

    @abstractmethod
    def draws(self, start: int = 0, stop: int | None = None) -> Floats:
        """Draw runs start to stop in the unit cube, on (run, varied parameter)."""

    def columns(self, start: int = 0, stop: int | None = None) -> dict[str, np.ndarray[Any, Any]]:
        """Draw one value per run of each varied parameter, in SI units, or one word."""
        unit = np.clip(self.draws(start, stop), _EDGE, 1 - _EDGE).T
        columns = zip(self.varied.items(), unit, strict=True)
        return {name: entry.quantile(draws) for (name, entry), draws in columns}


class DrawnTogether(RandomSample):
    """A sample that is drawn as a whole; of blocks it is kept for the next one."""

    @property
    def most_runs(self) -> int:
        """The most runs that it draws: memory holds them all."""
        return DRAWN_TOGETHER

    @abstractmethod
    def all_draws(self) -> Floats:
        """Draw all runs in the unit cube, on (run, varied parameter)."""

    @cached_property
    def _kept_draws(self) -> Floats:
        if self.runs > _SLOWLY_DRAWN:
            log.info("method %s draws all %s runs at once", self.method, f"{self.runs:,}")
        return self.all_draws()

    def draws(self, start: int = 0, stop: int | None = None) -> Floats:
        """Draw runs start to stop in the unit cube, on (run, varied parameter)."""
        is_whole = start == 0 and stop in (None, self.runs)
        return self.all_draws() if is_whole else self._kept_draws[start:stop]


def _read_groups(data: Any) -> Mapping[str, tuple[str, ...]]:
    if not isinstance(data, dict):
        raise ValueError("expected a mapping such as {steel: [beam_density, beam_yield_stress]}")
    if odd := [name for name in data if not isinstance(name, str) or not LABEL.fullmatch(name)]:
        raise ValueError(
            f"{odd[0]!r} cannot name a group: use letters, digits, _ and -, starting with a "
            "letter or a digit"
        )
    return TypeAdapter(Mapping[str, Names]).validate_python(data)


@dataclass(frozen=True, kw_only=True)
class Grouped(RandomSample):
    """A sample that gives one index per group of parameters.

    groups: the varied parameters of each group by its name; a parameter that is not named is a
    group of its own.

    Raises ValueError unless every group has a name of its own, each member is a varied parameter
    of one group alone, and there are two groups or more.
    """

    groups: Annotated[Mapping[str, Sequence[str]], PlainValidator(_read_groups)] = field(
        default_factory=dict
    )

    @property
    def group_of(self) -> dict[str, str]:
        """The group of each varied parameter, in their order."""
        group = {member: name for name, members in self.groups.items() for member in members}
        return {name: group.get(name, name) for name in self.varied}

    @property
    def settings(self) -> dict[str, Any]:
        """The attributes of a design that describe its draws."""
        groups = {"groups": list(self.group_of.values())} if self.groups else {}
        return super().settings | groups

    @property
    def group_count(self) -> int:
        """Number of varied groups, each of which has indices of its own."""
        return len(set(self.group_of.values()))

    @model_validator(mode="after")
    def _check_groups(self) -> Self:
        seen: set[str] = set()
        for group, members in self.groups.items():
            if group in self.parameters:
                raise at_key(f"groups.{group}", "is the name of a parameter: choose another name")
            for index, member in enumerate(members):
                if member in self.fixed:
                    reason = "is fixed, so it belongs to no group: take it out"
                elif member not in self.varied:
                    reason = unknown("varied parameter", member, self.varied)
                elif member in seen:
                    reason = "is named more than once: each parameter has one group"
                else:
                    seen.add(member)
                    continue
                raise at_key(f"groups.{group}.{index}", reason)
        return self


@dataclass(frozen=True, kw_only=True)
class Table(RandomSample):
    """Rows of a design made elsewhere, or of measurements, each a draw of its own."""

    label = "table"
