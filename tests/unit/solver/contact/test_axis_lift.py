"""The lift of the axis: its data, an even pressure in closed form, which body yields."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import brentq

import impactlab as il
from impactlab.model.case_table import case_table
from impactlab.simulate import run_dataset
from impactlab.solver.contact import LAWS, axis_lift, finite_element
from impactlab.solver.contact.history import CONTACT, Pair, load, make_pair
from impactlab.solver.contact.stronge import yield_indentation
from impactlab.verification.solutions.hertz import effective_modulus

E, R, S_y, nu = 115e9, 0.035, 345e6, 0.3
HARD = 2550e6
DATA = pd.read_csv(Path(finite_element.__file__).with_name("axis_lift.csv"))
FIRST = yield_indentation(E, R, S_y)


def loaded(x, law="finite_element"):
    contact, pair = np.zeros(1, CONTACT)[0], Pair(LAWS.index(law), E, R, S_y, nu)
    load(contact, pair, x * FIRST)
    return contact, pair


@pytest.mark.parametrize("share", ["0.1", "0.2", "0.3", "0.4"])
def test_lift_of_a_dent_is_that_of_finite_elements(share):
    table = DATA[DATA.x >= 5.0]
    ours = []
    for x in table.x:
        contact, pair = loaded(x)
        z = finite_element.radius(x * FIRST, E, R, S_y, nu) / float(share)
        ours.append(axis_lift.axis_lift(contact, pair, 0.0, z, 0.0, HARD) / FIRST)
    missed = (np.array(ours) - table[share]) / table.x
    assert abs(missed).max() < 1e-3  # of the indentation
    assert abs(missed).mean() < 3e-4
    assert (table[share] / table.x).max() > 1.5e-3  # what would be missed without it


def test_lift_under_pressure_is_that_of_an_even_one():
    modulus, z = 210e9, 0.0139
    contact, pair = loaded(0.9)
    a, F = finite_element.radius(0.9 * FIRST, E, R, S_y, nu), contact.F_m
    s, p = np.hypot(a, z), F / (np.pi * a**2)
    even = (1 + nu) * p / modulus * (2 * (1 - nu) * (s - z) + z - z**2 / s)
    point = F * (1 + nu) * (3 - 2 * nu) / (2 * np.pi * modulus * z)
    pressure = (1 + nu) * (5 - 2 * nu) / (8 * np.pi * modulus * z**3)
    lift = axis_lift.axis_lift(contact, pair, F, z, pressure, HARD)
    assert lift == pytest.approx(point - even, rel=2 * (a / z) ** 2)


def test_a_softer_sphere_takes_the_dent_and_lifts_nothing():
    contact, pair = loaded(50.0)
    assert axis_lift.axis_lift(contact, pair, 0.0, 0.0139, 0.0, HARD) > 0.0
    assert axis_lift.axis_lift(contact, pair, 0.0, 0.0139, 0.0, S_y) == 0.0
    assert axis_lift.axis_lift(*loaded(50.0, "hertz"), 0.0, 0.0139, 0.0, HARD) == 0.0


@pytest.mark.long  # a kernel of its own is compiled
def test_permanent_indentation_of_a_strip_is_dent_and_lift():
    impact = replace(il.corrected_impact(5.0), contact_prestress="ignored")
    grid = il.Discretisation(nodes=101)
    run = run_dataset(impact, grid, duration=0.25e-3)
    bodies = effective_modulus(impact), impact.sphere.radius, impact.beam.material.yield_stress, nu
    pair = make_pair(case_table(impact, grid, duration=0.25e-3)[0])
    law = *bodies, pair.shape, pair.crowding

    def missed(delta):
        return finite_element.curve(delta, *law)[0] - run.peak_force.item()

    delta = brentq(missed, 1e-5, 1e-3)
    share = finite_element.radius(delta, *bodies) / (0.5 * impact.beam.depth)
    raised = 1.0 + axis_lift.plastic_lift(delta / yield_indentation(*bodies[:3]), share)
    residual = finite_element.curve(delta, *law)[2]
    dent = residual * raised
    assert run.permanent_indentation.item() == pytest.approx(dent, rel=1e-6)
    assert raised > 1.005
