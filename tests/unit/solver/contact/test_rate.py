"""The contact's yield stress at its own strain rate: closed forms, energy, stability."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import impactlab as il
from impactlab.solver.contact import LAWS
from impactlab.solver.contact.history import CONTACT, Pair, load, yield_stress
from impactlab.solver.contact.rate import MODULUS, curve_of, dissipate, strain
from impactlab.solver.strain_rate import RateLaw

from ....benchmarks import strain_rate

E, R, S_y, nu = 115e9, 0.035, 345e6, 0.3
RATES = {"cowper_symonds": RateLaw(40.4, 5.0, 0.0), "johnson_cook": RateLaw(0.01, 0.0, 0.05)}
MATERIALS = {
    "cowper_symonds": {"rate_coefficient": "40.4 s-1"},
    "johnson_cook": {"rate_sensitivity": 0.05, "reference_rate": "0.01 s-1"},
}
every_rate = pytest.mark.parametrize("name", RATES)
pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")


def indent(name, rate, last=0.1, steps=2000, hardest=np.inf):
    """A contact whose representative strain, 0.2 sqrt(delta/R), grows at a constant rate."""
    rates = {"rate": RATES[name], "hardest": hardest}
    pair = Pair(LAWS.index("thornton"), E, R, S_y, nu, **rates)
    contact, dt = np.zeros(1, CONTACT)[0], last / steps / rate
    for growing in np.linspace(0.0, last, steps + 1)[1:]:
        delta = float(R * (5.0 * growing) ** 2)
        strain(contact, pair, delta, dt)
        load(contact, pair, delta)
    return contact, pair


@every_rate
@pytest.mark.parametrize("rate", [1.0, 200.0])
def test_at_a_constant_rate_the_yield_stress_is_that_of_the_law(name, rate):
    contact, pair = indent(name, rate)
    law = RATES[name]
    factor = 1 + (law.C * np.log(rate / law.D) if law.C > 0 else (rate / law.D) ** (1 / law.q))
    assert yield_stress(contact, pair) == pytest.approx(S_y * factor, rel=1e-3)
    still, hard = np.zeros(1, CONTACT)[0], Pair(pair.law, E, R, S_y * factor, nu)
    load(still, hard, contact.delta_m)
    assert contact.F_m == pytest.approx(still.F_m, rel=1e-3)


@every_rate
def test_before_it_yields_the_stress_is_elastic(name):
    strained = 0.9 * S_y / (MODULUS * E)
    contact, pair = indent(name, 200.0, last=strained)
    assert contact.stress == pytest.approx(0.9 * S_y, rel=1e-6)
    assert yield_stress(contact, pair) == S_y


def test_no_yield_stress_exceeds_that_of_the_other_body():
    contact, pair = indent("cowper_symonds", 200.0, hardest=500e6)
    assert contact.stress > 500e6
    assert yield_stress(contact, pair) == 500e6


@every_rate
@pytest.mark.parametrize("law", ["hertz", "stronge_consistent", "finite_element", "thornton"])
def test_a_strike_dissipates_what_its_force_takes(name, law):
    """delta = v t - c t^2 in and out: the work of the force is dissipated, to the last."""
    pair = Pair(LAWS.index(law), E, R, S_y, nu, rate=RATES[name])
    contact, steps, duration = np.zeros(1, CONTACT)[0], 8000, 2e-4
    contact.n, work, F_before, delta_before, least = 1.5, 0.0, 0.0, 0.0, 0.0
    for step in range(1, steps + 1):
        t = duration * step / steps
        delta = 4.0 * 200e-6 * (t / duration) * (1.0 - t / duration)
        strain(contact, pair, delta, duration / steps)
        if delta > contact.approach_m:
            before, lost = curve_of(contact), contact.work
            load(contact, pair, delta)
            dissipate(contact, before)
            least = min(least, contact.work - lost)
            F = contact.F_m
        else:
            F = contact.K * max(delta - contact.delta_r, 0.0) ** contact.n
        work += 0.5 * (F + F_before) * (delta - delta_before)
        F_before, delta_before = F, delta
    scale = contact.F_m * contact.delta_m
    assert contact.work == pytest.approx(work, abs=1e-5 * scale)
    assert least >= -1e-9 * scale


@pytest.mark.parametrize("base", [il.paper_impact, il.corrected_impact])
@every_rate
@pytest.mark.parametrize("velocity", [0.3, 5.0, 20.0])
def test_an_impact_at_a_rate_creates_no_energy_at_the_largest_step(base, name, velocity):
    impact = base(velocity=velocity)
    metal = replace(impact.beam.material, **MATERIALS[name])
    impact = replace(impact, beam=replace(impact.beam, material=metal))
    grid = il.Discretisation(nodes=41, points=5, courant=1.0)
    run = il.simulate(impact, grid, duration="0.6 ms", samples=2001)
    assert run.energy_error < 1e-2
    force = run.contact_force.values
    assert run.peak_force == pytest.approx(force.max(), rel=0.01)
    assert run.time_of_peak_force == pytest.approx(float(run.time[force.argmax()]), abs=3e-6)


TABLE = pd.read_csv(Path(__file__).parents[4] / "docs" / "agreement_rates.csv")
SOLID = TABLE[TABLE.model == strain_rate.SOLID]


@pytest.mark.parametrize(
    "row", list(SOLID.itertuples()), ids=lambda row: f"{row.velocity:g}, {row.law}"
)
def test_a_rate_changes_as_much_as_in_three_dimensions(row):
    """The dent, where half of it is gone, within 4.5 % of that of the static impact."""
    ours = strain_rate.changes(strain_rate.BEAM, row.velocity, row.law)
    limits = {"maximum_indentation": 2.5, "permanent_indentation": 4.5}
    for name in strain_rate.RESPONSES:
        assert ours[name] == pytest.approx(getattr(row, name), abs=limits.get(name, 2.3)), name
