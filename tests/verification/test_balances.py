"""Energy and momentum, for every rule, law and hardening."""

from collections import Counter
from dataclasses import replace

import numba
import numpy as np
import pytest

import impactlab as il
from impactlab.model.parameters import with_values
from impactlab.solver import RULES
from impactlab.solver.contact import LAWS
from impactlab.variables import STATUS_FLAGS
from impactlab.verification.cases import with_beam_material
from impactlab.verification.energy import audit

from .test_plain_beam import drawn

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")

NO_ANSWER = STATUS_FLAGS["diverged"][0] | STATUS_FLAGS["energy_out_of_balance"][0]


def hardened(impact, isotropic, kinematic):
    moduli = {"isotropic_hardening_modulus": isotropic, "kinematic_hardening_modulus": kinematic}
    return with_beam_material(impact, **moduli)


@pytest.mark.parametrize(
    ("scheme", "nodes", "bound"),
    [("leapfrog", 201, 1e-3), ("leapfrog", 601, 1e-4), ("modal", 51, 1e-3), ("modal", 151, 1e-4)],
)
def test_energy_error_of_the_papers_case(scheme, nodes, bound):
    grid = il.Discretisation(nodes=nodes, scheme=scheme)
    run = il.simulate(il.paper_impact(), grid, duration=1e-3)
    assert 0 < run.energy_error.item() < bound


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("contact", LAWS)
@pytest.mark.parametrize(("isotropic", "kinematic"), [(0, 0), (5e9, 0), (0, 5e9), (3e9, 3e9)])
def test_energy_balance_while_the_beam_yields(rule, contact, isotropic, kinematic):
    impact = hardened(il.paper_impact(20.0, contact), isotropic, kinematic)
    run = il.simulate(impact, il.Discretisation(nodes=101, points=9, rule=rule), duration=4e-3)
    start = 0.5 * run.sphere_mass.item() * 20.0**2
    assert run.plastic_dissipation.item() > 0.01 * start  # it does yield
    # a jump of the force at each turn costs accuracy
    assert run.energy_error.item() < (5e-3 if contact == "stronge_original" else 1e-3)


@pytest.mark.parametrize(("scheme", "nodes"), [("leapfrog", 101), ("modal", 31)])
@pytest.mark.parametrize("contact", sorted(set(LAWS) - {"kogut_etsion"}))
def test_energy_error_falls_with_the_time_step(contact, scheme, nodes):
    """An energy term left out would stay. kogut_etsion: its jumps fall somewhere in a step."""
    grid = il.Discretisation(nodes=nodes, scheme=scheme)
    grids = [replace(grid, courant=courant) for courant in (0.8, 0.4, 0.2)]
    impact = hardened(il.paper_impact(20.0, contact), 2e9, 2e9)
    runs = [il.simulate(impact, grid, duration=2e-3) for grid in grids]
    errors = np.array([run.energy_error.item() for run in runs])
    assert errors[2] < errors[0] / 4


@pytest.mark.parametrize("velocity", [0.25, 20.0])
def test_hertz_contact_dissipates_nothing(velocity):
    run = il.simulate(
        il.paper_impact(velocity, "hertz"), il.Discretisation(nodes=101), duration=25e-3
    )
    start = 0.5 * run.sphere_mass.item() * velocity**2
    assert abs(run.contact_dissipation.item()) < 1e-9 * start


def test_impulse_is_the_spheres_loss_of_momentum():
    impact = replace(il.paper_impact(5.0), gravity=0.0)
    run = il.simulate(impact, il.Discretisation(nodes=201), duration=20e-3)
    lost = run.sphere_mass.item() * (5.0 + run.rebound_velocity.item())
    assert run.impulse.item() == pytest.approx(lost, rel=1e-9)


def test_force_moves_the_beam():
    """Before the supports matter: rho A times the integral of w is the force integrated twice."""
    impact = il.paper_impact(0.99)
    time = 0.08e-3
    run = il.simulate(impact, il.Discretisation(nodes=401), duration=time, samples=4001)
    moved = impact.beam.mass_per_length * run.deflection.integrate("x").item()
    driven = (run.contact_force * (time - run.time)).integrate("time").item()
    assert moved == pytest.approx(driven, rel=2e-3)


@pytest.mark.filterwarnings("ignore::impactlab.ImplausibleWarning")
@pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="takes hours as plain Python")
@pytest.mark.parametrize(("scheme", "nodes", "cases"), [("leapfrog", 61, 99), ("modal", 31, 88)])
def test_balances_of_hundreds_of_impacts(scheme, nodes, cases):
    """Exact in an elastic beam; in one that yields, as good as the run itself reports."""
    seen = Counter()
    random = np.random.default_rng(1)
    for law in list(LAWS) * (cases // len(LAWS)):
        impact, grid = il.paper_impact(contact=law), il.Discretisation(nodes=nodes, scheme=scheme)
        duration = random.uniform(0.3e-3, 6e-3)
        found = audit(*with_values(impact, grid, drawn(random)), duration)
        run = found.run
        if run.status.item() & NO_ANSWER:
            seen["no answer"] += 1
            continue
        yields = run.peak_plastic_strain.item() > 0
        seen["yields" if yields else "stays elastic"] += 1
        assert abs(found.momentum) < 1e-9
        # few nodes and long steps are drawn, too: the run must say so itself
        assert abs(found.energy) < (0.01 + 5 * run.energy_error.item() if yields else 1e-9)
        assert run.plastic_dissipation.item() >= 0
        assert run.plastic_dissipation.item() == pytest.approx(found.plastic, rel=1e-9)
        created = bool(run.remarks.item() & 1)
        assert (run.contact_dissipation.item() < -1e-9 * found.brought) <= created
        assert created <= (law == "stronge")
    assert min(seen["yields"], seen["stays elastic"]) >= cases // 6, seen
    assert seen["no answer"] < cases // 10, seen
