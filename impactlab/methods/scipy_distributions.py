"""Frozen distributions of scipy.stats in place of this package's."""

from typing import Any

import numpy as np

from impactlab.methods.distributions import (
    Lognormal,
    LogUniform,
    Normal,
    Triangular,
    TruncatedNormal,
    Uniform,
)
from impactlab.methods.entries import Distribution

_FAMILIES = ("uniform", "loguniform", "reciprocal", "norm", "truncnorm", "lognorm", "triang")
"""Families of scipy.stats that have a counterpart."""


def is_frozen(entry: Any) -> bool:
    """Return whether this is a frozen distribution of SciPy."""
    return hasattr(entry, "dist") and hasattr(entry, "ppf")


def unfrozen(name: str, frozen: Any) -> Distribution:
    """Return the counterpart of a frozen distribution, in SI units; name: of the parameter.

    Raises ValueError for a family without one, and for a lognormal distribution that is moved.
    """
    family = frozen.dist.name
    if family not in _FAMILIES:
        raise ValueError(
            f"parameters.{name} is SciPy's {family}, which has no counterpart here: choose from "
            f"{', '.join(_FAMILIES)}, or use il.runs_of_table with a sample of your own"
        )
    names = [*filter(None, (frozen.dist.shapes or "").split(", ")), "loc", "scale"]
    stated = dict(zip(names, frozen.args, strict=False)) | frozen.kwds
    place, scale = float(stated.get("loc", 0.0)), float(stated.get("scale", 1.0))
    low, high = map(float, frozen.support())
    match family:
        case "uniform":
            return Uniform(low, high)
        case "loguniform" | "reciprocal":
            return LogUniform(low, high)
        case "norm":
            return Normal(mean=place, standard_deviation=scale)
        case "truncnorm":
            return TruncatedNormal(mean=place, standard_deviation=scale, low=low, high=high)
        case "triang":
            return Triangular(low=low, mode=place + float(stated["c"]) * scale, high=high)
    if place != 0.0:
        raise ValueError(
            f"parameters.{name} is SciPy's lognorm with loc = {place:g}: only loc = 0 has a "
            "counterpart here"
        )
    return Lognormal(median=scale, geometric_standard_deviation=float(np.exp(stated["s"])))
