"""Fit what reversed yielding adds to the unloading of the law `finite_element`.

    python tests/benchmarks/reversal.py

The data are unloading curves of indentation.csv, to 3 % of the largest force, and of reversal.csv,
to 0.3 %, where z is from 0.1 to 2.7 and the sphere is hardly softer than the hardened flat. What
the coefficients of metals.py say of the rest is kept, scaled to the force of the data. Least
squares over the mean and the scatter of each curve's errors, as shares of the largest force, and
over the dents of reversal.csv. Prints the constants of solver/contact/metals.py, and errors of the
fit and of runs held out (ten parts).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from contact_law import DATA, METALS, PARTS, REVERSED, curve, unloading
from scipy.optimize import least_squares

from impactlab.solver.contact import finite_element, metals

Floats = np.ndarray[Any, np.dtype[np.float64]]
START = 1.41, 0.3, -0.5, 0.6, 0.18, 0.01, 2.2, 0.5
"""Of t in z, of z_0, of what is recovered and of the exponent."""
SCALES = 0.008, 0.015, 0.012
"""Errors that weigh one: mean and scatter of a curve, share of a dent."""


class Branch(NamedTuple):
    """Unloading of one metal from one indentation.

    z: where t is 0; metal: share of the compliance, v and t; law: what is recovered without
    reversed yielding over the indentation, and the exponent; dent: over the indentation, or nan; x:
    below that indentation, over it; force: over the largest.
    """

    run: tuple[bool, int]
    z: float
    metal: tuple[float, float, float]
    law: tuple[float, float]
    dent: float
    x: Floats
    force: Floats


def branches(rows: pd.DataFrame, long: bool) -> list[Branch]:
    """Read branches of unloading; long: they go on until the dent is known."""
    curves = []
    for run, solve in rows.groupby("run"):
        metal = tuple(float(solve[name].iloc[0]) for name in METALS)
        ratio, share, nu, isotropic, kinematic, sphere = metal
        loading, shape = solve[solve.x == solve.x_max].set_index("x").F, curve(metal)
        delta_y = (0.825 * math.pi / ratio) ** 2
        for top, branch in solve[solve.x < solve.x_max].groupby("x_max"):
            z = metals.reversal(math.sqrt(top), shape)
            outgrown = metals.hardened(shape[25], top) > 1.3 * sphere
            is_fitted = 0.1 < z < metals.LARGEST_REVERSAL and not outgrown and top * delta_y < 0.05
            if top not in loading.index or not is_fitted:
                continue
            peak = loading[top]
            plain = (*shape[:26], 0.0, *shape[27:])
            F, _, dent, n = finite_element.curve(top * delta_y, ratio, 1.0, 1.0, nu, plain)
            scale = math.sqrt(peak * 4 / 3 * ratio * delta_y**1.5 / F)
            recovered = (top - dent / delta_y) * scale / top
            k, root = kinematic / (isotropic + kinematic), math.sqrt(top)
            hard = shape[25] * root
            z = (1 - 1 / root) ** 2 * k * k * hard / (1 + (1 - k) * hard)
            pair = share, 4 * (nu - 0.3), max(1 / sphere - 0.4, 0.0)
            end = unloading(branch, top, peak)[0] * math.sqrt(peak) / top
            x, force = 1 - branch.x.to_numpy() / top, branch.F.to_numpy() / peak
            known = 1 - end if long else math.nan
            curves.append(Branch((long, run), z, pair, (recovered, n), known, x, force))
    return curves


def unloaded(p: Floats, branch: Branch) -> tuple[float, float]:
    """Return what is recovered over the indentation, and the exponent."""
    (share, v, t), (recovered, n) = branch.metal, branch.law
    least = p[1] * (1 + p[2] * (2 * share - 1) + p[3] * v)
    excess = max(branch.z * max(1 - p[0] * t, 0.0) - least, 1e-9)
    dent = 1 / recovered - 1
    longer = p[4] * excess**2 * dent / (excess + p[5] * dent / share**2)
    return recovered * (1 + longer), n + p[6] * longer / (1 + p[7] * longer)


def errors(p: Floats, data: Sequence[Branch]) -> Floats:
    """Return mean and scatter of each curve's errors, and the error of each dent, (branches, 3)."""
    rows = []
    for branch in data:
        recovered, n = unloaded(p, branch)
        off = np.maximum(1 - branch.x / recovered, 0.0) ** n - branch.force
        dent = (1 - recovered) / branch.dent - 1
        rows.append((off.mean(), off.std(), 0.0 if math.isnan(dent) else dent))
    return np.array(rows)


def fitted(data: Sequence[Branch]) -> Floats:
    """Return the constants."""

    def residuals(p: Floats) -> Floats:
        return np.ravel(errors(p, data) / SCALES)

    return np.asarray(least_squares(residuals, START, loss="soft_l1").x)


def main() -> None:
    """Fit, and print constants and errors."""
    data = branches(pd.read_csv(DATA), False) + branches(pd.read_csv(REVERSED), True)
    runs = sorted({branch.run for branch in data})
    p = fitted(data)
    print("constants", p.round(3))
    held_out = []
    for part in range(PARTS):
        left = set(runs[part::PARTS])
        kept = fitted([branch for branch in data if branch.run not in left])
        held_out += [*errors(kept, [branch for branch in data if branch.run in left])]
    for name, table in (("fit", errors(p, data)), ("held out", np.array(held_out))):
        dents = 100 * table[:, 2][table[:, 2] != 0.0]
        curves = 100 * np.hypot(table[:, 0], table[:, 1])
        for what, off in (("dents", dents), ("force over the largest", curves)):
            print(f"{name}, {what}: {np.sqrt((off**2).mean()):.2f} % rms", end=", ")
            print(f"{np.abs(off).max():.1f} % at most, of {len(off)}")


if __name__ == "__main__":
    main()
