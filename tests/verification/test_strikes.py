"""Repeated strikes: energy balances, the beam at rest as the mean of its swing, both schemes."""

from dataclasses import replace

import numba
import numpy as np
import pytest
from scipy.optimize import brentq

import impactlab as il
from impactlab.solver.outputs import SERIES
from impactlab.verification.solutions.contact_laws import law_on_half_space

from ..end_modes import held

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")

FLOATING = replace(il.paper_impact(5.0), gravity=0.0)


def series(run, name):
    return run[f"{name}_over_strikes"].values


@pytest.mark.parametrize(
    ("law", "velocity"),
    [
        ("stronge", 0.4),  # creates energy
        ("stronge", 5.0),
        ("jackson_green", 5.0),
        ("thornton", 5.0),
        ("kogut_etsion", 2.0),
        ("finite_element", 0.99),
        ("finite_element", 10.0),
    ],
)
def test_a_rigid_beam_is_dented_as_the_energies_ask(law, velocity):
    """A strike first takes what the one before gave back, then what loading on takes."""
    impact = replace(FLOATING, velocity=velocity, contact=law, beam_model="rigid", strikes=5)
    steel = replace(impact.sphere.material, youngs_modulus=impact.beam.material.youngs_modulus)
    impact = replace(impact, sphere=replace(impact.sphere, material=steel))
    run = il.simulate(impact, il.Discretisation(nodes=5), duration="1 ms", samples=2)
    half_space, mass = law_on_half_space(impact), impact.sphere.total_mass
    energy = 0.5 * mass * velocity**2
    deepest, spent, dents, forces, rebounds, losses = 0.0, 0.0, [], [], [], []
    for _ in range(5):
        needed = spent + energy
        if deepest == 0.0 or half_space.loading_work(deepest) < needed:
            deepest = brentq(
                lambda d, W=needed: half_space.loading_work(d) - W, 1e-9, 0.01, xtol=1e-15
            )
            forces.append(half_space.loading_force(deepest))
        else:  # a law that creates energy: on the unloading curve, which stays
            force, _, n = half_space.unloading(deepest)
            forces.append(force * (energy / half_space.released_work(deepest)) ** (n / (n + 1)))
        released = half_space.released_work(deepest)
        spent = half_space.loading_work(deepest) - released
        dents.append(half_space.residual_indentation(deepest))
        rebounds.append(np.sqrt(min(released / energy, 1.0)) if len(dents) > 1 else np.nan)
        losses.append(spent)
    assert series(run, "permanent_indentation") == pytest.approx(dents, rel=2e-5, abs=1e-12)
    assert series(run, "peak_force") == pytest.approx(forces, rel=2e-5)
    assert series(run, "restitution")[1:] == pytest.approx(rebounds[1:], rel=2e-5)
    assert series(run, "contact_dissipation") == pytest.approx(losses, rel=1e-4, abs=1e-5 * energy)
    assert run.maximum_indentation.item() == pytest.approx(deepest, rel=2e-5)
    if law == "finite_element":
        growth = np.diff(dents)
        assert (growth > 0).all()
        assert (np.diff(growth) < 0).all()


@pytest.mark.parametrize(
    ("model", "scheme", "load", "damping"),
    [
        ("elastic", "leapfrog", "point", 0.0),
        ("elastic", "modal", "point", 0.0),
        ("elastic", "leapfrog", "contact_patch", 0.0),
        ("elastic", "modal", "contact_patch", 0.0),
        ("elastic", "leapfrog", "point", 20.0),
        ("elastic", "modal", "point", 20.0),
        ("timoshenko", "leapfrog", "point", 0.0),
        ("spring_mass", "leapfrog", "point", 0.0),
    ],
)
def test_strikes_that_leave_nothing_are_alike(model, scheme, load, damping):
    impact = replace(FLOATING, contact="hertz", velocity=1.0, beam_model=model, load=load)
    impact = replace(impact, beam=replace(impact.beam, mass_damping=damping))
    grid = il.Discretisation(nodes=41, scheme=scheme)
    once, thrice = (
        il.simulate(replace(impact, strikes=n), grid, duration="22 ms", samples=2) for n in (1, 3)
    )
    names = (
        "maximum_indentation",
        "time_of_peak_force",
        "contact_duration",
        "maximum_deflection",
        "impulse",
        "number_of_contacts",
        "total_contact_time",
        "peak_force",
    )
    for name in names:
        assert thrice[name].item() == pytest.approx(once[name].item(), rel=1e-4), name
    assert thrice.shakedown_strike.item() == 1
    for name in ("peak_force", "restitution"):
        assert np.ptp(series(thrice, name)) < 1e-9 * thrice[name].item()
    assert np.abs(series(thrice, "residual_deflection")).max() < 1e-12
    assert thrice.energy_error.item() < 1e-3


YIELDING = replace(FLOATING, velocity=20.0)
TIMOSHENKO = replace(YIELDING, beam_model="timoshenko")
ELASTIC_END = {
    f"{kind}stiffness_{side}": value
    for side in ("left", "right")
    for kind, value in (("", 5e7), ("rotational_", 2e5))
}


def at_rest(impact, grid, plastic_strain):
    """Return the deflection (m) of least elastic energy, by least squares, under plastic strains.

    Of rows that are roots of the energies of nodes, half-way slopes (with shear), springs and
    foundation.
    """
    beam, nodes = impact.beam, grid.nodes
    z, area = beam.section.cut(grid.rule, grid.points)
    EI, dx = beam.material.youngs_modulus * np.sum(area * z**2), beam.span / (nodes - 1)
    bent = -plastic_strain @ (area * z) / np.sum(area * z**2)
    deflects, slopes = np.eye(nodes), np.diff(np.eye(nodes), axis=0) / dx
    shears = impact.beam_model == "timoshenko"
    if shears:
        deflects = np.hstack([deflects, np.zeros((nodes, nodes - 1))])
        turns = np.eye(2 * nodes - 1)[nodes:]
        gap = np.hstack([slopes, np.zeros((nodes - 1, nodes - 1))]) - turns
        slopes = turns
    rows = [np.sqrt(EI * dx) * np.diff(slopes, axis=0) / dx]
    rights = [np.sqrt(EI * dx) * bent[1:-1]]
    for side, end, inward in (("left", 0, 1), ("right", -1, -1)):
        kind = getattr(beam, f"support_{side}")
        if kind == "clamped":
            rows.append(np.sqrt(0.5 * EI * dx) * inward * 2.0 * slopes[[end]] / dx)
            rights.append(np.sqrt(0.5 * EI * dx) * bent[[end]])
        if kind == "elastic":
            lift, turn = (getattr(beam, f"{of}stiffness_{side}") for of in ("", "rotational_"))
            series = 1.0 / (1.0 / turn + dx / (2.0 * EI))
            rows += [np.sqrt(lift) * deflects[[end]], np.sqrt(series) * slopes[[end]]]
            rights += [[0.0], [0.0]]
        if kind in ("pinned", "clamped"):
            rows.append(1e9 * deflects[[end]])
            rights.append([0.0])
    if shears:
        modulus = beam.material.youngs_modulus / (2.0 + 2.0 * beam.material.poissons_ratio)
        stiffness = beam.shear_correction * modulus * beam.section.area
        rows.append(np.sqrt(stiffness * dx) * gap)
        rights.append(np.zeros(nodes - 1))
    if beam.foundation_stiffness > 0.0:
        lengths = np.full(nodes, dx)
        lengths[[0, -1]] *= 0.5
        rows.append(np.sqrt(beam.foundation_stiffness * lengths)[:, None] * deflects)
        rights.append(np.zeros(nodes))
    matrix, right = np.vstack(rows), np.concatenate(rights)
    size = np.linalg.norm(matrix, axis=0)
    return (np.linalg.lstsq(matrix / size, right, rcond=1e-15)[0] / size)[:nodes]


@pytest.mark.parametrize(("place", "bed"), [(0.25, 0.0), (0.5, 0.0), (0.25, 3e7), (0.5, 3e7)])
@pytest.mark.parametrize(
    "ends",
    [
        ("pinned", "pinned"),
        ("clamped", "clamped"),
        ("pinned", "clamped"),
        ("clamped", "free"),
        ("elastic", "clamped"),
        ("elastic", "elastic"),
    ],
)
@pytest.mark.parametrize(
    ("impact", "scheme"),
    [(YIELDING, "leapfrog"), (YIELDING, "modal"), (TIMOSHENKO, "leapfrog")],
    ids=["leapfrog", "modal", "timoshenko"],
)
def test_rest_has_the_least_elastic_energy(impact, scheme, ends, place, bed):
    impact = replace(impact, beam=replace(impact.beam, foundation_stiffness=bed))
    if "elastic" in ends:
        impact = replace(impact, beam=replace(impact.beam, **ELASTIC_END))
    impact = held(*ends, place, impact)
    grid = il.Discretisation(nodes=41, scheme=scheme)
    run = il.simulate(replace(impact, strikes=2), grid, duration="25 ms", samples=2)
    expected = at_rest(impact, grid, run.plastic_strain.values)
    largest = np.abs(expected).max()
    softer = bed == 0.0 and ends != ("elastic", "elastic")
    assert largest > (1e-3 if softer else 2e-4)
    bound = 1e-7 if scheme == "leapfrog" else 0.02 if bed == 0.0 else 0.04  # of modes left out
    assert run.deflection.values == pytest.approx(expected, abs=bound * largest)
    under = expected[round(40 * place)]
    dents = series(run, "residual_deflection")
    assert dents[-1] == pytest.approx(under, rel=bound, abs=bound * largest)
    assert run.energy_error.item() < 5e-3


def test_a_strip_at_rest_is_the_mean_of_its_swing():
    """Under a window that lets no swing through; it still yields a little."""
    impact = replace(il.corrected_impact(20.0), gravity=0.0, strikes=2)
    grid = il.Discretisation(nodes=41)
    run = il.simulate(impact, grid, duration="0.4 s", samples=40001)
    w = run.midspan_deflection.values[10001:]
    assert np.abs(run.contact_force.values[10001:]).max() == 0.0
    window = np.blackman(w.size)
    mean = np.sum(window * w) / np.sum(window)
    assert series(run, "residual_deflection")[-1] == pytest.approx(mean, rel=5e-3)
    assert run.energy_error.item() < 5e-3


@pytest.mark.parametrize("scheme", ["leapfrog", "modal"])
def test_energy_is_balanced_over_all_strikes_on_a_moving_beam(scheme):
    """Without damping, with what each sphere brings and takes away."""
    impact = replace(FLOATING, velocity=1.0, strikes=5, strike_interval="31 ms")
    grid = il.Discretisation(nodes=41, scheme=scheme)
    grids = [replace(grid, courant=courant) for courant in (0.8, 0.2)]
    runs = [il.simulate(impact, fine, duration="22 ms", samples=2) for fine in grids]
    errors = [run.energy_error.item() for run in runs]
    assert 4.0 * errors[1] < errors[0] < 5e-3
    still = il.simulate(replace(impact, strike_interval=None), grid, duration="22 ms", samples=2)
    forces, at_rest = series(runs[1], "peak_force"), series(still, "peak_force")
    assert np.abs(forces[1:] / at_rest[1:] - 1.0).max() > 0.02  # it does move


def test_a_rigid_beam_does_not_know_of_the_time_between():
    impact = replace(FLOATING, beam_model="rigid", strikes=4)
    still, run = (
        il.simulate(case, il.Discretisation(nodes=5), duration="1 ms", samples=2)
        for case in (impact, replace(impact, strike_interval="3 ms"))
    )
    for name in SERIES:
        assert series(run, name) == pytest.approx(series(still, name), rel=1e-9), name


@pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="takes minutes as plain Python")
def test_both_schemes_agree_on_ten_strikes():
    impact = replace(il.paper_impact(5.0), strikes=10)
    grids = (
        il.Discretisation(nodes=201),
        il.Discretisation(nodes=129, scheme="modal"),
    )
    leapfrog, modal = (il.simulate(impact, grid, duration="12 ms", samples=2) for grid in grids)
    for run in (leapfrog, modal):
        growth = np.diff(series(run, "permanent_indentation"), prepend=0.0)
        assert (growth > 0).all()
        assert (np.diff(growth)[3:] < 0).all()
        assert np.isnan(run.shakedown_strike.item())
        assert run.energy_error.item() < 1e-3
    for name, rel in (
        ("permanent_indentation", 0.015),
        ("contact_dissipation", 0.025),
        ("peak_force", 0.02),
    ):
        assert series(modal, name) == pytest.approx(series(leapfrog, name), rel=rel), name


def test_studies_have_the_series_of_one_run():
    """Answers of the last strike are those of as many strikes; energies and dents add up."""
    impact = replace(il.paper_impact(1.0), strikes=30)
    grid = il.Discretisation(nodes=41, scheme="modal")
    run = il.simulate(impact, grid, duration="15 ms", samples=2)
    many = il.simulate_many(
        impact, grid, duration="15 ms", varied={"strikes": [30, 8], "velocity": [1.0, 0.5]}
    )
    for name in ("permanent_indentation", "peak_force", "restitution", "contact_dissipation"):
        assert many[name].values[0] == series(run, name)[-1] == run[name].item()
    assert many.strikes.values.tolist() == [30, 8]
    assert run.strike.values.tolist() == list(range(1, 31))
    dents = series(run, "permanent_indentation")
    grown = np.flatnonzero(np.diff(dents) > 1e-3 * dents[1:])
    assert run.plastic_dissipation.item() == 0.0
    assert run.shakedown_strike.item() == grown[-1] + 3


def test_a_strike_that_does_not_end_says_so():
    impact = replace(il.paper_impact(5.0), strikes=3)
    grid = il.Discretisation(nodes=41, scheme="modal")
    with pytest.warns(il.TooShortWarning, match="too short for strikes before the last: "):
        run = il.simulate(impact, grid, duration="0.1 ms", samples=2)
    assert "earlier_strike_unfinished" in run.status.flag_meanings
    assert run.status.item() == 512
    assert np.isnan(run.peak_force.item())
    assert np.isnan(series(run, "peak_force")).all()
    assert np.isfinite(run.contact_force.values).all()


def test_frames_are_of_one_strike():
    impact, grid = replace(il.paper_impact(), strikes=2), il.Discretisation(nodes=41)
    with pytest.raises(ValueError, match=r"^simulate\.frames = 5: must be 0 with several strikes"):
        il.simulate(impact, grid, duration="1 ms", frames=5)
