"""Methods of sampling and their indices, one file each.

A file holds the class of a method, which is the section of a study and an object in Python at once,
with its draws, and the record of its indices: variables, estimator, figure and verdicts. All
classes with a label here are methods; a line in impactlab/__init__.pyi makes one public.
"""

from collections.abc import Callable, Iterator, Mapping
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from pydantic import ValidationInfo

from impactlab.methods.grid import Grid
from impactlab.methods.hypercube import Hypercube
from impactlab.methods.record import Family, Indices
from impactlab.methods.runs import Sample
from impactlab.methods.sampling import RandomSample, Sampling, Table
from impactlab.validation.fields import name_at

for _module in iter_modules([str(Path(__file__).parent)]):
    import_module(f"{__name__}.{_module.name}")


def _subclasses(kind: Any) -> Iterator[type[RandomSample]]:
    for below in kind.__subclasses__():
        yield from [below, *_subclasses(below)]


SAMPLES: Mapping[str, type[RandomSample]] = {
    kind.name(): kind
    for kind in sorted(
        _subclasses(RandomSample), key=lambda kind: (issubclass(kind, Hypercube), kind.__name__)
    )
    if "label" in vars(kind)
}
"""Kinds of samples, by their names in study files and datasets: the Latin hypercubes last."""
METHODS: Mapping[str, type[Sampling]] = {Grid.name(): Grid} | {
    name: kind for name, kind in SAMPLES.items() if kind is not Table
}
"""Methods of studies: samples that are drawn, and the grid."""
INDICES: Mapping[str, Indices] = {
    record.name: record for kind in SAMPLES.values() for record in kind.records
}
"""Indices by their names in study files."""
FAMILIES: tuple[Family, ...] = tuple(
    {record.family.figure: record.family for record in INDICES.values()}.values()
)
"""Families of measures that rank the parameters."""
NO_DISTRIBUTION = {
    name: kind.no_distribution for name, kind in METHODS.items() if kind.no_distribution
}
"""Why the runs of a method do not represent the distribution of a response."""


def read_sampling(data: Any, info: ValidationInfo) -> Sampling:
    """Read the section `sampling` of a study. Raises ValueError naming the key at fault."""
    return METHODS[name_at("method", METHODS, data)].read(data, info.context)


def indices_of(attributes: Mapping[Any, Any]) -> list[Indices]:
    """Return the indices that runs with these attributes were drawn for; none for a grid."""
    if "indices" in attributes:
        return [INDICES[str(name)] for name in np.atleast_1d(attributes["indices"])]
    method = SAMPLES.get(str(attributes.get("method")))
    return list(method.records) if method else []


def independent_runs(sample: Sample) -> NDArray[np.int64]:
    """Return the numbers of the runs that are draws of their own: of a Sobol sample, A and B."""
    return SAMPLES[str(sample.settings["method"])].independent(sample)


def verdict_name(analysis: xr.Dataset, matches: Callable[[Indices], bool]) -> str:
    """Return the variable with the verdict on the indices that match.

    A sample with several indices has one for each; `sensitivity_verdict` is that on the first.
    """
    names = (f"{name}_verdict" for name, record in INDICES.items() if matches(record))
    return next((name for name in names if name in analysis), "sensitivity_verdict")
