"""The numbers to which tests hold a contact law's record, measured from the law's functions.

    python -m impactlab.verification.law_record NAME

prints them as lines of the record of law NAME in solver/contact/__init__.py. A new law has to be
listed there first, if only with its texts. All is for steel: E* = 115 GPa, S_y = 345 MPa, nu = 0.3.
Flow laws from outside are checked here, too.
"""

import math
import sys
from collections.abc import Mapping
from dataclasses import fields, replace
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.integrate import quad

from impactlab.copies import Copies
from impactlab.model.checks import one_of
from impactlab.model.contact_law import ContactLaw
from impactlab.model.flow_law import FlowLaw
from impactlab.solver.contact import CONTACT_LAWS, LAWS, LawRecord
from impactlab.solver.contact.switch import curve, limit
from impactlab.solver.jit import compiled
from impactlab.types import Floats

STEEL = (115e9, 0.035, 345e6, 0.3)
"""E* (Pa), R (m), S_y (Pa) and nu."""
NUMBERS = ("yield_pressure", "jumps", "unloading_start", "restitution", "creates", "dent")
_SMALLEST_JUMP = 1e-7
_STEEP = 3.0
"""d ln(F)/d ln(delta) beyond which a step of the indentation is searched for a jump."""


def measured(name: str | ContactLaw) -> LawRecord:
    """Return the record of a law with its numbers measured.

    yield_pressure stays as it is where the law is Hertz's beyond 1.1 times it: first yield may come
    before a curve leaves Hertz's.
    """
    law = _record(name)
    pressure = yield_pressure(name)
    if pressure > 1.1 * law.yield_pressure or pressure == 0.0:
        pressure = law.yield_pressure
    unit = _indentation(pressure)
    jumps = _jumps(name)
    joints = np.array([1.0, *(delta / unit for delta, _ in jumps)])
    ratios = [np.linspace(0.5, 3.5, 1201), np.geomspace(3.5, 1e3, 60)]
    ratios += [joints * (1.0 - 1e-9), joints * (1.0 + 1e-9)]
    deltas = unit * np.unique(np.concatenate(ratios))
    deltas = deltas[deltas < _limit(name)]
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


def _record(name: str | ContactLaw) -> LawRecord:
    return CONTACT_LAWS[name] if isinstance(name, str) else name


def _limit(name: str | ContactLaw) -> float:
    if isinstance(name, str):
        return float(limit(LAWS.index(name), *STEEL))
    return float(_compiled(name)["limit"](*STEEL))


@lru_cache(maxsize=8)
def _compiled(law: ContactLaw) -> dict[str, Any]:
    delta = 1e-3 * STEEL[1]
    arguments: dict[str, tuple[float, ...]] = {
        "curve": (delta, *STEEL),
        "limit": STEEL,
        "radius": (delta, *STEEL),
        "damping": (1.0, delta, 0.1, *STEEL),
    }
    return compiled_functions(law, arguments)


def compiled_functions(
    law: ContactLaw | FlowLaw, arguments: Mapping[str, tuple[float, ...]]
) -> dict[str, Any]:
    """Return a law's functions, compiled for themselves, under names of their own.

    arguments: to try each with. Raises ValueError where numba cannot compile one, or it returns
    something else.
    """

    def finish(original: Any, copy: Any) -> Any:
        copy.__qualname__ += f"_alone_{law.source_hash}"
        return compiled(copy)

    copies, functions = Copies(finish), {}
    for part, values in arguments.items():
        if getattr(law, part) is None:
            continue
        functions[part] = copies.of(getattr(law, part))
        try:
            answer = functions[part](*values)
        except Exception as error:  # of numba, many kinds
            reason = " ".join(str(error).strip().splitlines()[:4])
            raise ValueError(
                f"{law.kind} {law.name!r}: numba cannot compile {part}: {reason}"
            ) from None
        size, expected = 1, "one float"
        if part == "curve":
            size, expected = 4, "(F, K, delta_r, n), four floats"
        numbers = answer if size > 1 and isinstance(answer, tuple) else (answer,)
        if len(numbers) != size or not all(isinstance(number, float) for number in numbers):
            raise ValueError(
                f"{law.kind} {law.name!r}: {part} returns {answer!r}: expected {expected}"
            )
    return functions


def yield_pressure(name: str | ContactLaw) -> float:
    """Return the largest Hertz pressure over S_y up to which a law is Hertz's; inf for all."""
    low, high = 0.0, _limit(name)
    if _is_hertz(name, high):
        return math.inf
    low = high
    while not _is_hertz(name, low):
        low *= 0.5
        if low < 1e-12 * STEEL[1]:
            return 0.0
    while low < (middle := 0.5 * (low + high)) < high:
        low, high = (middle, high) if _is_hertz(name, middle) else (low, middle)
    modulus, radius, strength, _ = STEEL
    return float(2.0 * modulus / (math.pi * strength) * math.sqrt(low / radius))


def _is_hertz(name: str | ContactLaw, delta: float) -> bool:
    return np.allclose(along(name, [delta]), along("hertz", [delta]), rtol=1e-13, atol=0.0)


def _indentation(pressure: float) -> float:
    """Return the indentation (m) at a largest Hertz pressure, over S_y."""
    modulus, radius, strength, _ = STEEL
    return radius * (0.5 * math.pi * pressure * strength / modulus) ** 2


def depths(name: str | ContactLaw, number: int = 20001) -> Floats:
    """Return indentations (m) from 1e-6 of the sphere's radius to just beyond a law's limit."""
    return np.geomspace(1e-6 * STEEL[1], 1.01 * _limit(name), number)


def along(name: str | ContactLaw, deltas: Floats | list[float]) -> Floats:
    """Return (F, K, delta_r, n) of a law's curve at indentations in m, shape (4, len(deltas))."""
    if isinstance(name, str):
        return np.array([curve(LAWS.index(name), delta, *STEEL) for delta in deltas]).T
    return np.array([_compiled(name)["curve"](delta, *STEEL) for delta in deltas]).T


def _jumps(name: str | ContactLaw) -> list[tuple[float, float]]:
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


def _restitution(name: str | ContactLaw, deltas: Floats) -> tuple[Floats, Floats]:
    """Return coefficients of restitution, and residuals over `deltas` (m), by quadrature."""
    _, stiffness, end, exponent = along(name, deltas)
    pieces = [
        quad(lambda delta: along(name, [delta])[0, 0], start, stop, epsabs=1e-12, epsrel=1e-9)[0]
        for start, stop in pairwise((0.0, *deltas))
    ]
    work = np.cumsum(pieces)
    released = stiffness * (deltas - end) ** (exponent + 1.0) / (exponent + 1.0)
    return np.sqrt(released / work), end / deltas


def lines(name: str | ContactLaw) -> list[str]:
    """Return the numbers of the law that differ from a record's defaults, as its lines.

    Raises ValueError for a name that is not listed.
    """
    if isinstance(name, str):
        one_of("law_record", "name", name, LAWS)
    law, defaults = measured(name), {field.name: field.default for field in fields(LawRecord)}
    values = {number: _rounded(getattr(law, number)) for number in NUMBERS}
    return [
        f"{key}={value!r}," for key, value in values.items() if value != _rounded(defaults[key])
    ]


def _rounded(value: Any) -> Any:
    """Return a number, or the numbers of a tuple, with five digits."""
    return tuple(map(_rounded, value)) if isinstance(value, tuple) else float(f"{value:.5g}")


BODIES = (STEEL, (40e9, 0.01, 100e6, 0.33), (3e9, 0.005, 60e6, 0.4))
"""E*, R, S_y and nu of steel, aluminium and a polymer."""
_ROUNDING = 1e-6
_RATES = (-10.0, -0.1, 0.1, 10.0)


def refusals(law: ContactLaw) -> list[str]:
    """Return what of a law contradicts its record, or is impossible; in words, [] if nothing."""
    if reasons := impossible(law):
        return reasons
    found, reasons = measured(law), []
    if not math.isfinite(found.restitution):
        return ["its energies are not finite"]
    if found.jumps and len(found.jumps) != len(law.jumps):
        reasons.append("its loading force jumps")
    if abs(found.unloading_start - law.unloading_start) > 1e-4:
        share = f"{found.unloading_start:.4g}"
        reasons.append(f"unloading begins at {share} of the loading force at the worst")
    if found.restitution > law.restitution + 1e-4:
        reasons.append(
            f"it creates energy: the coefficient of restitution is up to {found.restitution:.5g}"
        )
    if found.dent < law.dent - 1e-4:
        reasons.append(f"it leaves a dent below zero, down to {found.dent:.4g} of the indentation")
    deltas = depths(law, 3)[:1]
    share = along(law, deltas)[0, 0] / along("hertz", deltas)[0, 0]
    if law.hertzian_start and not abs(share - 1.0) < 1e-3:
        reasons.append(
            f"it begins with {share:.4g} of Hertz's force: state hertzian_start=False if it should"
        )
    if (found.restitution > 1.0 + _ROUNDING or found.jumps or found.dent < 0.0) and not law.flaws:
        reasons.append("state in `flaws`, in words, what it does")
    return reasons


def impossible(law: ContactLaw) -> list[str]:
    """Return what no record can state of a law, in words. Raises ValueError if it is no code."""
    functions = _compiled(law)
    reasons = [reason for bodies in BODIES for reason in _impossible(functions, bodies)]
    return list(dict.fromkeys(reasons))


def _impossible(functions: dict[str, Any], bodies: tuple[float, ...]) -> list[str]:
    """Return what no law may do, between these bodies."""
    end, reasons = functions["limit"](*bodies), []
    if not (math.isfinite(end) and end > 0.0):
        return [f"limit gives {end!r}, which is no indentation"]
    deltas = np.geomspace(1e-6 * end, end, 300)
    rows = np.array([functions["curve"](delta, *bodies) for delta in deltas])
    circles = np.array([functions["radius"](delta, *bodies) for delta in deltas])
    if not np.isfinite(rows).all() or (rows[:, 0] <= 0.0).any() or (rows[:, 1] <= 0.0).any():
        reasons.append("curve gives forces that are not finite and above zero up to its limit")
    elif (rows[:, 2] >= deltas).any() or (rows[:, 3] < 1.0).any():
        reasons.append("curve gives delta_r that is not below delta, or n below 1")
    if not (np.isfinite(circles).all() and (circles > 0.0).all()):
        reasons.append("radius gives circles that are not finite and above zero")
    if not reasons and "damping" in functions:
        for delta, force in zip(deltas[::30], rows[::30, 0], strict=True):
            powers = [functions["damping"](force, delta, rate, *bodies) * rate for rate in _RATES]
            if not np.isfinite(powers).all() or min(powers) < 0.0:
                reasons.append("damping creates energy: its force has not the sign of the rate")
            if not abs(functions["damping"](force, delta, 0.0, *bodies)) <= _ROUNDING * force:
                reasons.append("damping is not zero at rest")
    return list(dict.fromkeys(reasons))


METALS = ((206e9, 345e6), (70e9, 250e6), (3e9, 60e6))
"""E and S_y (Pa) of steel, aluminium and a polymer."""
_STRAINS = np.concatenate([[0.0], np.geomspace(1e-6, 1.0, 61)])
_FLOW_RATES = np.concatenate([[0.0], np.geomspace(1e-4, 1e6, 41)])
_FLOW_ROUNDING = 1e-9
_PRINTED = ((0.002, 0.0), (0.05, 0.0), (0.05, 1e3))


@lru_cache(maxsize=8)
def _compiled_flow(law: FlowLaw) -> Any:
    return compiled_functions(law, {"flow_stress": (0.01, 1.0, *METALS[0])})["flow_stress"]


def flow_refusals(law: FlowLaw) -> list[str]:
    """Return what no flow law may do and this one does, in words; [] if nothing.

    Raises ValueError if it is no code.
    """
    function, reasons = _compiled_flow(law), []
    for metal in METALS:
        stress = np.array([[function(p, rate, *metal) for rate in _FLOW_RATES] for p in _STRAINS])
        if not np.isfinite(stress).all():
            reasons.append("flow_stress is not finite for all p from 0 to 1 and rates to 1e6 1/s")
            continue
        stress /= metal[1]
        if abs(stress[0, 0] - 1.0) > _FLOW_ROUNDING:
            reasons.append(f"it begins at {stress[0, 0]:.5g} S_y, not at S_y")
        falls = np.argwhere(np.diff(stress, axis=0) < -_FLOW_ROUNDING)
        if falls.size:
            p = _STRAINS[falls[0, 0] + 1]
            reasons.append(
                f"the stress falls at p = {p:.3g}: all bending would go to one section, however "
                "short the spacing"
            )
        falls = np.argwhere(np.diff(stress, axis=1) < -_FLOW_ROUNDING)
        if falls.size:
            reasons.append(
                f"the stress falls with the rate at {_FLOW_RATES[falls[0, 1] + 1]:.3g} 1/s"
            )
    return list(dict.fromkeys(reasons))


def flow_lines(law: FlowLaw) -> list[str]:
    """Return the numbers of a flow law for steel, in lines."""
    function, steel = _compiled_flow(law), METALS[0]
    ratios = [(p, rate, function(p, rate, *steel) / steel[1]) for p, rate in _PRINTED]
    return [
        f"flow stress at p = {p}, rate {rate:g} 1/s: {ratio:.4g} S_y" for p, rate, ratio in ratios
    ]


if __name__ == "__main__":
    print(*lines(*sys.argv[1:]), sep="\n")
