"""The wings: folders of this package with a file `wing.py`, whose WING says what they add.

The core imports no wing. It reads these records, which import nothing themselves, and resolves
their references, as `pkgutil.resolve_name` takes them, only for studies that need them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from pathlib import Path
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


@dataclass(frozen=True, kw_only=True)
class Size:
    """A parameter of the mesh of a wing's model, and a field of Discretisation.

    cost_power: its power in the cost of a run; below zero, less is finer.
    """

    name: str
    units: str
    long_name: str
    cost_power: int


@dataclass(frozen=True, kw_only=True)
class FurtherModel:
    """A model of the beam beside those of the kernels.

    name: in `beam_model`; label: in figures; solver: name of its solver in designs; trait: of
    studies that have runs of it; advice: where it can be solved. sizes: of its mesh, of which a run
    needs one; axis, axis_title: prefix of their variables in the analysis, and title. variables:
    name, unit, meaning and comment of answers that the beam models do not have.

    references: its `solver` (a study.solvers.Solver); `axis` (an analysis.convergence.axes.Axis);
    `checks` of studies that have runs of it, see study.schema.checks; `costs`, see study.estimate;
    `figures` by name; `sections` of the report; and `compile`, which compiles its kernels.
    """

    name: str
    label: str
    solver: str
    trait: str
    advice: str
    sizes: tuple[Size, ...]
    axis: str
    axis_title: str
    variables: tuple[tuple[str, str, str, str], ...]
    references: Mapping[str, str]

    def part(self, name: str) -> Any:
        """Return what one of the references is to."""
        return resolve_name(self.references[name])


@dataclass(frozen=True, kw_only=True)
class Wing:
    """Additions of a wing: references to commands by name; contents of files (files.CONTENTS)."""

    commands: Mapping[str, str]
    contents: Mapping[str, str] = field(default_factory=dict)
    models: tuple[FurtherModel, ...] = ()


@cache
def _wings() -> list[Wing]:
    folders = sorted(path.parent.name for path in Path(__file__).parent.glob("*/wing.py"))
    return [import_module(f"impactlab.{name}.wing").WING for name in folders]


def commands() -> dict[str, str]:
    """Return references to the commands of all wings, by name."""
    return {name: place for wing in _wings() for name, place in wing.commands.items()}


def contents() -> dict[str, str]:
    """Return what files of the wings hold, and the command that makes each."""
    return {name: command for wing in _wings() for name, command in wing.contents.items()}


def models() -> dict[str, FurtherModel]:
    """Return the models of the beam that wings add, by name."""
    return {model.name: model for wing in _wings() for model in wing.models}


def sizes() -> dict[str, Size]:
    """Return the parameters of the meshes of all these models, by name."""
    return {size.name: size for model in models().values() for size in model.sizes}


def among(names: ArrayLike) -> list[FurtherModel]:
    """Return the models of wings that are among these values of `beam_model`."""
    import numpy as np  # late: the command line begins without

    return [model for name, model in models().items() if np.isin(name, names)]
