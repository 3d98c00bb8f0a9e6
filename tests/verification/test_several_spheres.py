"""Several spheres: symmetry, momentum, energy, superposition, and what one sphere does alone."""

from dataclasses import replace

import numpy as np
import pytest

import impactlab as il
from impactlab.verification.cases import with_beam_material

from ..end_modes import held

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")

GRID = il.Discretisation(nodes=41)
PAPER = replace(il.paper_impact(5.0), strike_position=0.25)


def test_mirrored_spheres_do_the_same():
    """Yielding fibres are mirrored with the rest."""
    impact = replace(PAPER, velocity=20.0)
    impact = replace(impact, further_spheres=[{"strike_position": 0.75, "velocity": "20 m/s"}])
    run = il.simulate(impact, GRID, duration="1.5 ms", samples=101)
    assert run.peak_plastic_strain.item() > 1e-3
    w, force = run.deflection.values, run.contact_force_of_spheres.values
    assert w == pytest.approx(w[::-1], rel=1e-9)
    assert run.plastic_strain.values == pytest.approx(run.plastic_strain.values[::-1], abs=1e-12)
    assert force[1] == pytest.approx(force[0], rel=1e-9, abs=1e-6)
    assert (force[0] == run.contact_force.values).all()
    for name in ("peak_force", "impulse", "contact_duration", "permanent_indentation"):
        first, second = run[f"{name}_of_spheres"].values
        assert first == run[name].item()
        assert second == pytest.approx(first, rel=1e-9), name


def test_a_sphere_that_comes_too_late_changes_no_bit():
    alone = il.simulate(PAPER, GRID, duration="2 ms", samples=101)
    late = replace(PAPER, further_spheres="0.6 5 0.002001")
    both = il.simulate(late, GRID, duration="2 ms", samples=101)
    for name, variable in alone.variables.items():
        assert np.array_equal(
            both[name].values, variable.values, equal_nan=variable.dtype == float
        ), name
    assert both.status_of_spheres.values[0] == alone.status.item()
    assert both.status_of_spheres.values[1] & 2  # its first contact is unfinished
    assert (both.contact_force_of_spheres.values[1] == 0.0).all()
    assert both.number_of_contacts_of_spheres.values[1] == 0


def test_the_blows_move_a_free_beam():
    """Its centre is where the forces moved it, of which one acts on an end."""
    impact = replace(held("free", "free", 0.25, il.paper_impact(5.0)), gravity=0.0)
    blows = [
        {"strike_position": 1.0, "velocity": 2.0, "delay": "0.13 ms"},
        {"strike_position": 0.6, "velocity": 4.0},
    ]
    run = il.simulate(replace(impact, further_spheres=blows), GRID, duration="1 ms", samples=4001)
    moved = impact.beam.mass_per_length * run.deflection.integrate("x").item()
    forces = run.contact_force_of_spheres
    driven = (forces * (1e-3 - run.time)).integrate("time").values
    assert (driven > 0.05 * driven.max()).all()
    assert moved == pytest.approx(driven.sum(), rel=1e-4)
    assert forces.integrate("time").values == pytest.approx(run.impulse_of_spheres.values, rel=1e-4)


def test_energy_is_balanced_over_all_spheres():
    """To an error that falls with the time step: a term left out would stay."""
    hard = with_beam_material(
        il.paper_impact(15.0), isotropic_hardening_modulus=2e9, kinematic_hardening_modulus=2e9
    )
    impact = replace(held("clamped", "free", 0.25, hard), further_spheres="1 8 3.1e-4, 0.5 15 1e-4")
    grids = [replace(GRID, courant=courant) for courant in (0.8, 0.2)]
    runs = [il.simulate(impact, grid, duration="2 ms", samples=2) for grid in grids]
    errors = [run.energy_error.item() for run in runs]
    assert runs[0].plastic_dissipation.item() > 1.0
    assert 4.0 * errors[1] < errors[0] < 3e-3


def test_spheres_exchange_their_roles():
    """However little energy the first one brings: the audit is over that of all."""
    slow = replace(PAPER, velocity=0.05, further_spheres="0.75 10 0")
    fast = replace(PAPER, velocity=10.0, strike_position=0.75, further_spheres="0.25 0.05 0")
    runs = [il.simulate(impact, GRID, duration="1 ms", samples=51) for impact in (slow, fast)]
    forces = [run.contact_force_of_spheres.values for run in runs]
    assert forces[0].max(axis=1).min() > 1e4
    assert forces[0][::-1] == pytest.approx(forces[1], rel=1e-9)
    assert runs[0].energy_error.item() == pytest.approx(runs[1].energy_error.item(), rel=1e-6)


@pytest.mark.parametrize("model", ["elastic", "euler_bernoulli"])
def test_blows_superpose(model):
    """The modal series of an elastic beam under both forces; the second does as it does alone."""
    small = replace(PAPER, velocity=0.1, strike_position=0.1, beam_model=model)
    delay, duration, place = 0.0987e-3, 0.5e-3, 0.8
    grid = il.Discretisation(nodes=101)
    blow = {"strike_position": place, "velocity": 0.5, "delay": delay}
    run = il.simulate(replace(small, further_spheres=[blow]), grid, duration=duration, samples=4001)
    alone = replace(small, strike_position=place, velocity=0.5)
    single = il.simulate(alone, grid, duration=duration - delay, samples=2)
    for name in ("peak_force", "contact_duration", "impulse", "permanent_indentation"):
        second = run[f"{name}_of_spheres"].values[1]
        assert second == pytest.approx(single[name].item(), rel=3e-3), name
    beam, t = small.beam, run.time.values
    k = np.arange(1, 60)[:, None] * np.pi / beam.span
    omega = k**2 * np.sqrt(beam.bending_stiffness / beam.mass_per_length)
    q = 0.0
    forces = run.contact_force_of_spheres.values
    for x, force in zip((0.1, place), forces, strict=True):
        pushes = np.sin(omega * (duration - t)) * force
        q = q + np.sin(k[:, 0] * x * beam.span) * np.trapezoid(pushes, t, axis=1)
    q = q / (0.5 * beam.mass_per_length * beam.span * omega[:, 0])
    w = np.sin(k * run.x.values).T @ q
    assert run.deflection.values == pytest.approx(w, abs=2e-3 * np.abs(w).max())


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"beam_model": "timoshenko"}, r"^Impact\.beam_model = 'timoshenko': must be euler_ber"),
        ({"load": "contact_patch"}, r"^Impact\.load = 'contact_patch': must be point with further"),
        ({"strikes": 2}, r"^Impact\.strikes = 2: must be 1 with further_spheres: change it"),
        ({"contact": "hunt_crossley"}, "^further_spheres: must be left out with a viscous contact"),
        ({"scheme": "modal"}, "^further_spheres: must be left out with scheme: modal"),
        ({"further_spheres": "0.33 1 0"}, "^further_spheres: lies between two of the 41 nodes"),
        ({"further_spheres": "0.25 1 0"}, "must have a place of its own each: strikes and"),
        (
            {"further_spheres": "0.25000000001 1 0"},
            "^further_spheres: must have a place of its own",
        ),
        ({"further_spheres": "0.75 1"}, r"a row needs 3 numbers: strike_position, velocity, delay"),
        ({"further_spheres": "1 1 0"}, "must have places above 0 and below 1 of the span, or at a"),
        ({"further_spheres": [{"velocity": 1}]}, r"must be a list of spheres, 1 to 8, as \[\{str"),
    ],
)
def test_what_has_one_sphere_alone_is_refused(change, message):
    grid = replace(GRID, scheme=change.pop("scheme", "leapfrog"))
    with pytest.raises(ValueError, match=message):
        il.simulate(
            replace(PAPER, **{"further_spheres": "0.75 1 0"} | change), grid, duration="1 ms"
        )


def test_a_list_of_spheres_varies_in_no_study():
    with pytest.raises(ValueError, match="further_spheres: is the same in all runs: vary velocity"):
        il.simulate_many(
            PAPER, GRID, duration="1 ms", varied={"further_spheres": ["0.75 1 0", "0.5 1 0"]}
        )
    varied = {"velocity": [1.0, 2.0]}
    impact = replace(PAPER, further_spheres=[(0.75, "3 m/s", "0.1 ms")])
    assert impact.further_spheres == "0.75 3.0 0.0001"
    many = il.simulate_many(impact, GRID, duration="1 ms", varied=varied)
    run = il.simulate(replace(impact, velocity=2.0), GRID, duration="1 ms", samples=2)
    assert many.peak_force.values[1] == run.peak_force.item()
