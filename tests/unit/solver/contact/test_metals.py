"""The law `finite_element` over the metals of both bodies, beside the finite elements."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.integrate import cumulative_trapezoid
from scipy.stats import qmc

from impactlab.solver.contact import finite_element, metals
from impactlab.solver.contact.stronge import yield_indentation

BENCHMARKS = Path(__file__).parents[3] / "benchmarks"
DATA, REVERSAL, DEEPER, FIRST_DENTS = (
    pd.read_csv(BENCHMARKS / f"{name}.csv")
    for name in ("indentation", "reversal", "deeper", "first_dents")
)
E, R, NU = 115e9, 0.035, 0.3
for data in (DATA, DEEPER):
    data["bias"] = 0.004 * (20 / data.elements) ** 2
"""Share by which the mesh makes the force too small (contact_law.py)."""
SOFT = DATA[DATA.run.between(204, 227)]
curve = getattr(finite_element.curve, "py_func", finite_element.curve)
radius = getattr(finite_element.radius, "py_func", finite_element.radius)
shape = getattr(metals.shape, "py_func", metals.shape)


def shape_of(row):
    hardening = row.isotropic + row.kinematic
    kinematic = row.kinematic / hardening if hardening else 0.0
    return shape(row.E_over_S, row.share, row.nu, hardening, kinematic, row.sphere_yield)


def outgrows(metal, of, x):
    is_far = metals.reversal(np.sqrt(x), of) > metals.FAR_REVERSAL
    largest = metals.LARGEST_HARDENED_FAR if is_far else metals.LARGEST_HARDENED
    return metals.hardened(of[25], x) > largest * metal.sphere_yield


def test_force_and_unloading_are_those_of_the_finite_elements():
    """Force by thirds of each loading in the law's range; of unloading, force over the largest.

    The latter where it was fitted, and throughout. And where unloading ends, of what is recovered:
    where F^(2/3) of its last tenth vanishes.
    """
    forces, unloading, beyond, ends = [], [], [], []
    for _, run in DATA.groupby("run"):
        S_y, of = E / run.E_over_S.iloc[0], shape_of(run.iloc[0])
        delta_y = yield_indentation(E, R, S_y)
        run = run[run.x_max <= finite_element.limit(E, R, S_y, NU) / delta_y]
        F_y = 4.0 / 3.0 * E * np.sqrt(R) * delta_y**1.5
        tops = {x: curve(x * delta_y, E, R, S_y, NU, of) for x in run.x_max.unique()}
        loading = run[(run.x == run.x_max) & (run.x > 1.05)]
        ours = np.array([tops[x][0] / F_y for x in loading.x])
        missed = np.log(ours / loading.F) - loading.bias
        forces.append([part.mean() for part in np.array_split(missed.to_numpy(), 3)])
        for x, F, top in run[run.x < run.x_max][["x", "F", "x_max"]].to_numpy():
            F_m, K, delta_r, n = tops[top]
            left = K * max(x * delta_y - delta_r, 0.0) ** n
            largest = loading.F[loading.x == top]
            if len(largest):
                error = left / F_m - F / largest.iloc[0]
                fitted = metals.reversal(np.sqrt(top), of) <= 1.0
                fitted &= not outgrows(run.iloc[0], of, top)
                (unloading if fitted else beyond).append(error)
        for top, branch in run[run.x < run.x_max].groupby("x_max"):
            share = branch.F / loading.F[loading.x == top].max()
            last = (share > 0.015) & (share < 0.12)
            slope, start = np.polyfit(branch.x[last], share[last] ** (2 / 3), 1)
            delta_r = tops[top][2] / delta_y
            if last.sum() > 2 and delta_r < 0.4 * top:
                ends.append((delta_r + start / slope) / (top - delta_r))
    forces = np.array(forces)
    assert len(forces) > 200
    assert np.sqrt((forces**2).mean(axis=0)).max() < 0.011
    assert abs(forces).max() < 0.05
    assert len(unloading) > 20 * len(beyond)
    assert np.sqrt(np.mean(np.square(unloading))) < 0.008
    assert np.sqrt(np.mean(np.square(unloading + beyond))) < 0.0105
    assert len(ends) > 100
    assert abs(np.mean(ends)) < 0.002
    assert np.sqrt(np.mean(np.square(ends))) < 0.005


def test_deep_indentations_solved_after_the_fit_are_as_it_has_them():
    """Force from 0.024 R on, and where F^0.675 of the last three forces vanishes."""
    forces, dents = [], []
    for _, run in DEEPER[DEEPER.E_over_S <= 600].groupby("run"):
        S_y, of = E / run.E_over_S.iloc[0], shape_of(run.iloc[0])
        delta_y = yield_indentation(E, R, S_y)
        run = run[run.x_max * delta_y <= 0.045 * R]
        F_y = 4.0 / 3.0 * E * np.sqrt(R) * delta_y**1.5
        loading = run[(run.x == run.x_max) & (run.x * delta_y > 0.024 * R)]
        ours = np.array([curve(x * delta_y, E, R, S_y, NU, of)[0] / F_y for x in loading.x])
        if len(loading):
            forces.append(np.mean(np.log(ours / loading.F) - loading.bias))
        for top, branch in run[run.x < run.x_max].groupby("x_max"):
            if top * delta_y < 0.02 * R or metals.reversal(np.sqrt(top), of) > 0.45:
                continue
            last = branch.nsmallest(3, "F")
            slope, start = np.polyfit(last.x, last.F**0.675, 1)
            dents.append(-curve(top * delta_y, E, R, S_y, NU, of)[2] / delta_y * slope / start - 1)
    assert min(len(forces), len(dents)) > 15
    assert np.sqrt(np.mean(np.square(forces))) < 0.025
    assert np.sqrt(np.mean(np.square(dents))) < 0.012


def test_contact_circles_are_those_of_the_finite_elements():
    """Metal sinks in the more around a circle, the more it hardens."""
    missed, hard = [], []
    for _, run in DATA.groupby("run"):
        S_y, of = E / run.E_over_S.iloc[0], shape_of(run.iloc[0])
        delta_y = yield_indentation(E, R, S_y)
        element = run.a_over_R.max() / run.elements.iloc[0]
        inside = (run.a_over_R > 8 * element) & (run.x * delta_y < finite_element.LARGEST_DEPTH * R)
        for x, a in run[inside & (run.x == run.x_max)][["x", "a_over_R"]].to_numpy()[::3]:
            ours = radius(x * delta_y, E, R, S_y, NU, of) / R
            missed.append(np.log(ours / (a + 0.3 * element)))  # as in the mean of Hertz
            hard.append(of[25] * np.sqrt(x))
    missed, group = np.array(missed), np.digitize(hard, [0.1, 0.3, 0.6, 1.0])
    assert np.bincount(group).min() > 50
    assert np.sqrt(np.mean(missed**2)) < 0.05
    assert abs(np.bincount(group, missed) / np.bincount(group)).max() < 0.03


def test_dents_of_metals_that_yield_in_reverse_are_those_of_the_finite_elements():
    """Where F^(2/3) of the last three forces vanishes, of unloading to 0.3 % of the largest force.

    With and without isotropic hardening, from well before it yields in reverse to where z is held,
    in the law's range and where runs have no mark.
    """
    missed, recovered, reversals = [], [], []
    for _, run in REVERSAL.groupby("run"):
        of, S_y = shape_of(run.iloc[0]), E / run.E_over_S.iloc[0]
        delta_y = yield_indentation(E, R, S_y)
        for top, branch in run[run.x < run.x_max].groupby("x_max"):
            z = metals.reversal(np.sqrt(top), of)
            if top * delta_y > finite_element.limit(E, R, S_y, NU) or z > metals.LARGEST_REVERSAL:
                continue
            if outgrows(run.iloc[0], of, top):
                continue
            last = branch.nsmallest(3, "F")
            slope, start = np.polyfit(last.x, last.F ** (2 / 3), 1)
            dent = curve(top * delta_y, E, R, S_y, NU, of)[2] / delta_y
            missed.append(-dent * slope / start - 1.0)
            recovered.append((top - dent) / (top + start / slope) - 1.0)
            reversals.append(z)
    missed, recovered = np.array(missed), np.array(recovered)
    group = np.digitize(reversals, [0.3, 0.5, 1.0])
    assert np.bincount(group).min() > 12
    assert max(reversals) > 0.9 * metals.LARGEST_REVERSAL
    rms = np.sqrt(np.bincount(group, missed**2) / np.bincount(group))
    assert (rms < [0.01, 0.012, 0.01, 0.02]).all()
    assert abs(missed[group < 3]).max() < 0.03
    assert abs(missed).max() < 0.036
    assert abs(np.mean(recovered[group > 1])) < 0.006


@pytest.mark.parametrize("nu", [0.05, 0.18, 0.3, 0.45])
def test_metal_yields_where_the_von_mises_stress_of_hertz_reaches_its_yield_stress(nu):
    """On the axis of the contact, with its peak pressure 1.5 times the mean (Johnson 1985)."""
    z = np.linspace(0.01, 2.0, 2000)  # over the contact radius
    sideways = (1.0 + nu) * (z * np.arctan(1.0 / z) - 1.0) + 0.5 / (1.0 + z**2)
    mises = np.max(np.abs(-1.0 / (1.0 + z**2) - sideways))  # over the peak pressure
    assert metals.first_yield(nu) == pytest.approx(1.0 / (1.5 * 1.1 * mises), rel=1e-4)
    of, S_y = shape(100.0, 0.5, nu, 0.0, 0.0, np.inf), E / 100.0
    first = yield_indentation(E, R, S_y) * metals.first_yield(nu) ** 2
    assert curve(0.999 * first, E, R, S_y, nu, of)[2] == 0.0
    assert 0.0 < curve(1.01 * first, E, R, S_y, nu, of)[2] < 0.001 * first


def test_dents_a_few_first_yields_deep_are_those_of_the_finite_elements():
    """Dents end where F^0.675 of the last three forces vanishes; unloading gives back its work."""
    dents, missed, works = [], [], []
    for _, run in FIRST_DENTS.groupby("run"):
        of, S_y = shape_of(run.iloc[0]), E / run.E_over_S.iloc[0]
        delta_y = yield_indentation(E, R, S_y)
        for top, branch in run[run.x < run.x_max].groupby("x_max"):
            last, peak = branch.nsmallest(3, "F"), run.F[run.x == top].iloc[0]
            slope, start = np.polyfit(last.x, last.F**0.675, 1)
            _, _, delta_r, n = curve(top * delta_y, E, R, S_y, NU, of)
            dents.append(-start / slope / top)
            missed.append(delta_r / delta_y / top / dents[-1] - 1.0)
            x, F = [dents[-1] * top, *branch.x[::-1], top], [0.0, *branch.F[::-1], peak]
            works.append((top - delta_r / delta_y) * peak / (n + 1.0) / np.trapezoid(F, x) - 1.0)
    missed, group = np.array(missed), np.digitize(dents, [0.015, 0.06, 0.1])
    assert np.bincount(group)[1:].min() > 8
    rms = np.sqrt(np.bincount(group, missed**2) / np.bincount(group))
    assert (rms < [0.08, 0.03, 0.015, 0.016]).all()
    assert abs(missed[group > 1]).max() < 0.045
    assert abs(missed[group == 1]).max() < 0.1
    assert np.abs(works).max() < 0.01


@pytest.mark.parametrize(
    ("metal", "x", "share"),
    [
        ((83.2, 0.291, 0.138, 0.00526, 0.0, 1.045), 3.5, 0.47),
        ((83.2, 0.291, 0.138, 0.00526, 0.0, 1.5), 3.5, 1.0),
        ((333.0, 0.5, 0.3, 0.0, 0.0, 1.0), 130.0, 0.48),
        ((333.0, 0.5, 0.3, 0.0, 0.0, 1.3), 130.0, 0.85),
        ((333.0, 0.5, 0.3, 0.0, 0.0, 2.0), 130.0, 1.0),
    ],
)
def test_the_softer_metal_has_the_share_that_3d_shows(metal, x, share):
    """By what a stress along the beam changes, beside what it does under a sphere that is hard."""
    assert metals.softer_share(x, shape(*metal)) == pytest.approx(share, abs=0.05)


def test_soft_metals_are_met_or_marked():
    """Force over the last third of loading; marks by hardening, as of a run of the same depth.

    A fit without them is 7 and 9 % off for two of the marked ones (contact_law.py, held out).
    """
    missed, marked = [], []
    for _, run in SOFT.groupby("run"):
        metal, x = run.iloc[0], run.x_max.max()
        S_y, of = E / metal.E_over_S, shape_of(metal)
        delta_y = yield_indentation(E, R, S_y)
        loading = run[run.x == run.x_max].tail(len(run[run.x == run.x_max]) // 3)
        ours = np.array([curve(top * delta_y, E, R, S_y, NU, of)[0] for top in loading.x])
        F_y = 4.0 / 3.0 * E * np.sqrt(R) * delta_y**1.5
        missed.append(np.mean(np.log(ours / F_y / loading.F)) - metal.bias)
        modulus = metal.E_over_S * (1.0 - metal.nu**2) / metal.share  # Young's, over S
        strain = 0.2 * np.sqrt(2.0 * x * delta_y / R)
        flow = 1.0 + modulus * (metal.isotropic + metal.kinematic) * strain
        assert metals.hardened(of[25], x) == pytest.approx(flow, rel=1e-12)
        reverses = metals.reversal(np.sqrt(x), of) > metals.LARGEST_REVERSAL
        marked.append(outgrows(metal, of, x) or reverses)
    missed, marked = np.array(missed), np.array(marked)
    assert (marked.sum(), len(marked)) == (3, 24)
    assert abs(missed[~marked]).max() < 0.02
    assert np.sqrt(np.mean(missed[~marked] ** 2)) < 0.01


def metals_within_the_data(number):
    """Yield E*/S_y and the shapes of a Sobol sample over the range of the law."""
    for u in qmc.Sobol(7, seed=3).random(number):
        ratio = metals.LEAST_RATIO * (metals.LARGEST_RATIO / metals.LEAST_RATIO) ** u[0]
        share = metals.LEAST_SHARE + (metals.LARGEST_SHARE - metals.LEAST_SHARE) * u[1]
        hardening = metals.LARGEST_HARDENING * u[3] ** 2 * (u[4] > 0.2)
        hardness = 1.0 / max(u[5], 0.05)
        yield ratio, shape(ratio, share, 0.05 + 0.4 * u[2], hardening, u[6], hardness)


@pytest.mark.parametrize("crowding", [(0.0, 0.0), (1e3, 0.0), (1e5, 0.0), (1e3, 1e5)])
def test_no_metal_creates_energy(crowding):
    """Unloading gives back less than the work of loading; the dent is between 0 and delta."""
    for ratio, of in metals_within_the_data(256):
        S_y = E / ratio
        delta_y = yield_indentation(E, R, S_y)
        deepest = max(1.5 * finite_element.LARGEST_DEPTH * R / delta_y, 3.0)
        x = 0.6 + np.geomspace(1e-2, deepest, 180)
        F, _, delta_r, n = np.array(
            [curve(value * delta_y, E, R, S_y, NU, of, crowding) for value in x]
        ).T
        F, dent = F / (4.0 / 3.0 * E * np.sqrt(R) * delta_y**1.5), delta_r / delta_y
        work = 0.4 * 0.6**2.5 + cumulative_trapezoid(np.append(0.6**1.5, F), np.append(0.6, x))
        assert (np.diff(F) > 0.0).all()
        assert (F * (x - dent) / (n + 1.0) <= work).all(), (ratio, of)
        assert (dent >= 0.0).all()
        assert (dent < x).all()
        assert ((n >= 1.0) & (n <= 4.5)).all()
