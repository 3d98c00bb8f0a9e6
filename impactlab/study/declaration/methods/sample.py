"""A sample: runs drawn from distributions of parameters that vary independently."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

from impactlab.model.parameters import Value
from impactlab.study.declaration.distributions import Distribution
from impactlab.study.declaration.drawn import Fixed, drawn
from impactlab.study.declaration.form import Reader, Whole, between
from impactlab.study.declaration.methods.sampling import Sampling
from impactlab.study.declaration.values import Factor


class Sample(Sampling):
    """Draws of two or more parameters.

    seed: the same one gives the same draws, 0 like any other. parameters: a distribution each,
    or one fixed value.
    """

    fewest: ClassVar[int] = 2

    seed: Annotated[Whole, between(0, 2**32 - 1)] = 1
    parameters: Mapping[str, Distribution | Fixed[Any]]

    @staticmethod
    def entry(factor: Factor) -> Reader:
        """A distribution, or a fixed value."""
        return drawn(factor)

    @property
    def varied(self) -> dict[str, Distribution]:
        """The distributions by parameter: without the fixed ones, which no sampler sees."""
        given = self.parameters.items()
        return {name: each for name, each in given if isinstance(each, Distribution)}

    @property
    def fixed(self) -> dict[str, Value]:
        """The parameters listed with one value."""
        given = self.parameters.items()
        return {name: each.value for name, each in given if isinstance(each, Fixed)}

    @property
    def settings(self) -> dict[str, Any]:
        """What else the section says: the attributes of the design that tell how it was drawn."""
        said = self.model_dump(exclude={"method", "parameters", "groups", "until"})
        return {key: int(value) for key, value in said.items()}

    def bounds(self) -> dict[str, tuple[Value, ...]]:
        """Low and high of the bounded distributions, and the fixed values."""
        ends = {name: tuple(each.bounds().values()) for name, each in self.varied.items()}
        single = {name: (value,) for name, value in self.fixed.items()}
        return {name: found for name, found in (ends | single).items() if found}
