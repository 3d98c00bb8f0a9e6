"""The numbers to which tests hold a contact law's record, measured from the law's functions.

    python -m impactlab.verification.law_record NAME

prints them as lines of the record of law NAME in solver/contact/__init__.py. A new law has to be
listed there first, if only with its texts. All is for steel: E* = 115 GPa, S_y = 345 MPa, nu = 0.3.
"""

from __future__ import annotations

import math
import sys
from dataclasses import fields, replace
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.integrate import quad

from impactlab.solver.contact import CONTACT_LAWS, LAWS, ContactLaw
from impactlab.solver.contact.switch import curve, limit
from impactlab.types import Floats
from impactlab.validation.errors import unknown

STEEL = (115e9, 0.035, 345e6, 0.3)
"""E* (Pa), R (m), S_y (Pa) and nu."""
NUMBERS = ("yield_pressure", "jumps", "unloading_start", "restitution", "creates", "dent")
_SMALLEST_JUMP = 1e-7
_STEEP = 3.0
"""d ln(F)/d ln(delta) beyond which a step of the indentation is searched for a jump."""


def measured(name: str) -> ContactLaw:
    """Return the record of a law with its numbers measured.

    yield_pressure stays as it is where the law is Hertz's beyond 1.1 times it: first yield may come
    before a curve leaves Hertz's.
    """
    law = CONTACT_LAWS[name]
    pressure = yield_pressure(name)
    if pressure > 1.1 * law.yield_pressure:
        pressure = law.yield_pressure
    unit = _indentation(pressure)
    jumps = _jumps(name)
    joints = np.array([1.0, *(delta / unit for delta, _ in jumps)])
    ratios = [np.linspace(0.5, 3.5, 1201), np.geomspace(3.5, 1e3, 60)]
    ratios += [joints * (1.0 - 1e-9), joints * (1.0 + 1e-9)]
    deltas = unit * np.unique(np.concatenate(ratios))
    deltas = deltas[deltas < limit(LAWS.index(name), *STEEL)]
    restitution, dent = _restitution(name, deltas)
    creating = deltas[restitution > 1.0 + 1e-6] / unit
    loading, stiffness, end, exponent = along(name, depths(name))
    start = stiffness * (depths(name) - end) ** exponent / loading
    return replace(
        law,
        yield_pressure=pressure,
        jumps=tuple((delta / unit, height) for delta, height in jumps),
        unloading_start=float(start.min()),
        restitution=float(restitution.max()),
        creates=(float(creating[0]), float(creating[-1])) if creating.size else (1.0, 1.0),
        dent=float(dent.min()),
    )


def yield_pressure(name: str) -> float:
    """Return the largest Hertz pressure over S_y up to which a law is Hertz's; inf for all."""
    low, high = 0.0, limit(LAWS.index(name), *STEEL)
    if _is_hertz(name, high):
        return math.inf
    low = high
    while not _is_hertz(name, low):
        low *= 0.5
    while low < (middle := 0.5 * (low + high)) < high:
        low, high = (middle, high) if _is_hertz(name, middle) else (low, middle)
    modulus, radius, strength, _ = STEEL
    return float(2.0 * modulus / (math.pi * strength) * math.sqrt(low / radius))


def _is_hertz(name: str, delta: float) -> bool:
    return np.allclose(along(name, [delta]), along("hertz", [delta]), rtol=1e-13, atol=0.0)


def _indentation(pressure: float) -> float:
    """Return the indentation (m) at a largest Hertz pressure, over S_y."""
    modulus, radius, strength, _ = STEEL
    return radius * (0.5 * math.pi * pressure * strength / modulus) ** 2


def depths(name: str, number: int = 20001) -> Floats:
    """Return indentations (m) from 1e-6 of the sphere's radius to just beyond a law's limit."""
    return np.geomspace(1e-6 * STEEL[1], 1.01 * limit(LAWS.index(name), *STEEL), number)


def along(name: str, deltas: Floats | list[float]) -> Floats:
    """Return (F, K, delta_r, n) of a law's curve at indentations in m, shape (4, len(deltas))."""
    return np.array([curve(LAWS.index(name), delta, *STEEL) for delta in deltas]).T


def _jumps(name: str) -> list[tuple[float, float]]:
    """Return (indentation in m, relative height) of each jump of the loading force."""
    deltas = depths(name)
    logarithms = np.log(along(name, deltas)[0])
    jumps = []
    for i in np.flatnonzero(np.abs(np.diff(logarithms)) > _STEEP * np.diff(np.log(deltas))):
        low, high = deltas[i : i + 2]
        while low < (middle := 0.5 * (low + high)) < high:
            start, between, end = along(name, [low, middle, high])[0]
            steeper_first = abs(between - start) > abs(end - between)
            low, high = (low, middle) if steeper_first else (middle, high)
        start, end = along(name, [low, high])[0]
        if abs(end / start - 1.0) > _SMALLEST_JUMP:
            jumps.append((float(high), float(end / start - 1.0)))
    return jumps


def _restitution(name: str, deltas: Floats) -> tuple[Floats, Floats]:
    """Return coefficients of restitution, and residuals over `deltas` (m), by quadrature."""
    _, stiffness, end, exponent = along(name, deltas)
    pieces = [
        quad(lambda delta: along(name, [delta])[0, 0], start, stop, epsabs=1e-12, epsrel=1e-9)[0]
        for start, stop in pairwise((0.0, *deltas))
    ]
    work = np.cumsum(pieces)
    released = stiffness * (deltas - end) ** (exponent + 1.0) / (exponent + 1.0)
    return np.sqrt(released / work), end / deltas


def lines(name: str) -> list[str]:
    """Return the numbers of a law that differ from a record's defaults, as its lines.

    Raises ValueError for a name that is not listed.
    """
    if name not in CONTACT_LAWS:
        raise ValueError(unknown("contact law", name, LAWS))
    law, defaults = measured(name), {field.name: field.default for field in fields(ContactLaw)}
    values = {number: _rounded(getattr(law, number)) for number in NUMBERS}
    return [
        f"{key}={value!r}," for key, value in values.items() if value != _rounded(defaults[key])
    ]


def _rounded(value: Any) -> Any:
    """Return a number, or the numbers of a tuple, with five digits."""
    return tuple(map(_rounded, value)) if isinstance(value, tuple) else float(f"{value:.5g}")


if __name__ == "__main__":
    print(*lines(*sys.argv[1:]), sep="\n")
