"""Fit the dents of the law `finite_element` a few first yields deep.

    python tests/benchmarks/first_dents.py

The data are the last forces of unloading in first_dents.csv (contact_law.py solve "first dents"):
40 elements over the contact, for with 20 such dents are up to 2.5, with 10 up to 25 % off (twelve
metals), as the last node of the contact comes and goes. Least squares over the logarithm of each
dent over its indentation, those below 0.03 with less weight. Prints the constants of
solver/contact/metals.py, and errors of the law, of the fit and of metals held out (ten parts), by
the dent over the indentation.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from contact_law import FIRST_DENTS, METALS, PARTS, curve, unloading
from scipy.optimize import least_squares

from impactlab.solver.contact import finite_element, metals

Floats = np.ndarray[Any, np.dtype[np.float64]]
START = -0.5, 0.2, -1.0, 1.7, -0.25, 0.2
"""Factors of ln A, of p, and in the exponential."""
LEAST = 0.03
GROUPS = 0.0, 0.015, 0.06, 0.1, 0.22, 0.4


class Dent(NamedTuple):
    """One dent. y: of both bodies; q: of the softer; dent, law: over the indentation."""

    run: int
    share: float
    y: tuple[float, float]
    q: float
    x: float
    dent: float
    law: float


def read() -> list[Dent]:
    """Return the dents of the data, and what the law has them without this fit."""
    dents = []
    for run, solve in pd.read_csv(FIRST_DENTS).groupby("run"):
        metal = tuple(float(solve[name].iloc[0]) for name in METALS)
        ratio, share, nu, _, _, sphere = metal
        shape, loading = curve(metal), solve[solve.x == solve.x_max].set_index("x").F
        y = metals.first_yield(nu), metals.first_yield(0.3) * sphere
        late = (*shape[:32], 0.0, *shape[33:])  # no dent is early, and none is Hertz's
        for top, branch in solve[solve.x < solve.x_max].groupby("x_max"):
            delta_y = (0.825 * math.pi / ratio) ** 2
            law = finite_element.curve(top * delta_y, ratio, 1.0, 1.0, nu, late)[2] / delta_y / top
            law = max(law, 0.0)
            peak = float(loading[top])
            end = unloading(branch, top, peak)[0] * math.sqrt(peak) / top
            dents.append(Dent(int(run), share, y, shape[25], top, 1.0 - end, law))
    return dents


def first_dents(p: Floats, dents: list[Dent]) -> Floats:
    """Return what the fit has each dent over its indentation."""
    share, y, q, x = (
        np.array([getattr(dent, name) for dent in dents]) for name in ("share", "y", "q", "x")
    )
    total = np.zeros_like(x)
    for number, (own, hardened) in enumerate(((share, q), (1.0 - share, 0.0))):
        w = np.maximum(1.0 - y[:, number] / np.sqrt(x), 1e-9)
        log_A = p[0] + p[1] * np.log(own) + p[2] * hardened
        part = np.exp(log_A + p[5] * w) * w ** (p[3] + p[4] * np.log(own))
        total += part**metals.BOTH_BODIES
    return np.asarray(total ** (1.0 / metals.BOTH_BODIES))


def blended(p: Floats, dents: list[Dent]) -> Floats:
    """Return each dent as the law has it with the fit."""
    late = np.array([1.0 - min(dent.y) / math.sqrt(dent.x) for dent in dents])
    early = np.interp(late, finite_element.FIRST_DENTS, (1.0, 0.0))
    return early * first_dents(p, dents) + (1.0 - early) * np.array([dent.law for dent in dents])


def fitted(dents: list[Dent]) -> Floats:
    """Return the constants."""
    near = finite_element.FIRST_DENTS[1] + 0.03
    near_dents = [dent for dent in dents if 1.0 - min(dent.y) / math.sqrt(dent.x) < near]
    known = np.array([dent.dent for dent in near_dents])

    def residuals(p: Floats) -> Floats:
        return np.minimum(known / LEAST, 1.0) * np.log(first_dents(p, near_dents) / known)

    return np.asarray(least_squares(residuals, START).x)


def main() -> None:
    """Fit, and print constants and errors."""
    dents = read()
    known, p = np.array([dent.dent for dent in dents]), fitted(dents)
    print("constants", p.round(3))
    runs, held_out = sorted({dent.run for dent in dents}), np.zeros_like(known)
    for part in range(PARTS):
        left = np.isin([dent.run for dent in dents], runs[part::PARTS])
        kept = fitted([dent for dent, out in zip(dents, left, strict=True) if not out])
        held_out[left] = blended(kept, dents)[left]
    laws = {
        "without it": np.array([dent.law for dent in dents]),
        "fit": blended(p, dents),
        "held out": held_out,
    }
    group = np.digitize(known, GROUPS)
    for name, answers in laws.items():
        off = 100.0 * (answers / known - 1.0)
        for number, (low, high) in enumerate(pairwise(GROUPS), 1):
            part = off[group == number]
            print(f"{name}, {low:g} to {high:g}: {np.sqrt((part**2).mean()):.1f} % rms", end=", ")
            print(f"{np.abs(part).max():.1f} % at most, of {len(part)}")


if __name__ == "__main__":
    main()
