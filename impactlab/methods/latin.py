"""One Latin hypercube for several indices."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import PlainValidator, ValidationInfo

from impactlab.methods.hypercube import Hypercube
from impactlab.methods.record import Indices
from impactlab.validation.fields import names


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
