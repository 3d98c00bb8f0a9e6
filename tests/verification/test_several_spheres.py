"""Several spheres: symmetry, momentum, energy, superposition, and what one sphere does alone."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import simpson

import impactlab as il
from impactlab.model.case_table import case_table
from impactlab.solver.sphere_table import make_table
from impactlab.verification.cases import with_beam_material

from ..end_modes import held

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")

GRID = il.Discretisation(nodes=41)
PAPER = replace(il.paper_impact(5.0), strike_position=0.25)
BEAMS = pytest.mark.parametrize(
    ("model", "scheme"),
    [
        *((model, "leapfrog") for model in ("euler_bernoulli", "timoshenko", "von_karman")),
        ("euler_bernoulli", "modal"),
    ],
)
OPTIONS = {
    "plain": {},
    "modal": {},
    "timoshenko": {"beam_model": "timoshenko"},
    "von Karman": {"beam_model": "von_karman"},
    "prestress": {"beam_model": "timoshenko", "contact_prestress": "bending"},
    "compliance": {"beam_model": "timoshenko", "contact_compliance": "beam"},
    "strip": {"beam_model": "timoshenko", "contact_compliance": "strip"},
    "patch": {"load": "contact_patch"},
    "patch on the strip": {
        "beam_model": "timoshenko",
        "contact_compliance": "strip",
        "load": "contact_patch",
    },
    "strikes": {"strikes": 3},
    "modal strikes": {"strikes": 3},
    "strikes on the moving beam": {"strikes": 3, "strike_interval": 0.031},
    "modal strikes on the moving beam": {"strikes": 3, "strike_interval": 0.031},
    "all": {
        "beam_model": "timoshenko",
        "contact_prestress": "bending",
        "load": "contact_patch",
        "strikes": 3,
    },
}
OPTION = pytest.mark.parametrize("option", OPTIONS)
ALONE = ("peak_force", "contact_duration", "impulse", "permanent_indentation")


def optional(option, velocity=5.0, **values):
    """Return an impact with an option, and its grid."""
    paper = replace(il.paper_impact(velocity, "finite_element"), strike_position=0.25)
    scheme = "modal" if option.startswith("modal") else "leapfrog"
    return replace(paper, **OPTIONS[option], **values), replace(GRID, scheme=scheme)


def energy_errors(impact, grid, duration):
    """Return the errors with a long and a short time step, and the first of both runs."""
    grids = [replace(grid, courant=courant) for courant in (0.8, 0.2)]
    runs = [il.simulate(impact, fine, duration=duration, samples=2) for fine in grids]
    return [run.energy_error.item() for run in runs], runs[0]


@OPTION
def test_mirrored_spheres_do_the_same(option):
    """Yielding fibres are mirrored with the rest."""
    # at 5 m/s a touch of the modal scheme only grazes, which multiplies rounding
    yields, velocity = list(OPTIONS).index(option) < 4, 4.9
    if yields:
        velocity = 20.0
    impact, grid = optional(option, velocity, further_spheres=f"0.75 {velocity} 0, 0.5 4 1e-4")
    run = il.simulate(impact, grid, duration="1.5 ms" if yields else "10 ms", samples=101)
    # rounding grows with every touch of a beam that chatters, and sums over modes round otherwise
    share = 1e-6 if option == "modal" else 1e-8
    w, strain, force = (
        run[name].values for name in ("deflection", "plastic_strain", "contact_force_of_spheres")
    )
    assert w == pytest.approx(w[::-1], abs=share * np.abs(w).max())
    if yields:
        assert run.peak_plastic_strain.item() > 1e-3
        assert strain == pytest.approx(strain[::-1], abs=1e-11 if option == "modal" else 1e-12)
        assert force[1] == pytest.approx(force[0], rel=share, abs=1e-6)
    else:
        assert (run.status_of_spheres.values == 0).all()
    if "strikes" not in OPTIONS[option]:
        assert (force[0] == run.contact_force.values).all()
    for name in ALONE:
        first, second, _ = run[f"{name}_of_spheres"].values
        assert first == run[name].item()
        assert second == pytest.approx(first, rel=share), name


@OPTION
def test_a_sphere_that_comes_too_late_changes_no_bit(option):
    impact, grid = optional(option)
    alone = il.simulate(impact, grid, duration="10 ms", samples=101)
    late = replace(impact, further_spheres="0.6 9 0.010001")
    both = il.simulate(late, grid, duration="10 ms", samples=101)
    for name, variable in alone.variables.items():
        assert np.array_equal(
            both[name].values, variable.values, equal_nan=variable.dtype == float
        ), name
    assert both.status_of_spheres.values[0] == alone.status.item()
    assert both.status_of_spheres.values[1] & 2  # its first contact is unfinished
    assert (both.contact_force_of_spheres.values[1] == 0.0).all()
    assert both.number_of_contacts_of_spheres.values[1] == 0


@pytest.mark.parametrize(
    "option", [option for option in OPTIONS if "strikes" not in OPTIONS[option]]
)
@pytest.mark.parametrize("end", ["pinned", "clamped", "free"])
def test_half_a_beam_moves_as_the_whole(option, end):
    """A second sphere, which comes too late, makes one of the other."""
    impact, grid = optional(option, 20.0)
    impact = held(end, end, 0.5, impact)
    if end == "free" and impact.contact_compliance == "strip":
        pytest.skip("no strip has free ends")
    whole = replace(impact, further_spheres="0.75 9 0.002001")
    ours, both = (il.simulate(each, grid, duration="2 ms") for each in (impact, whole))
    assert ours.peak_plastic_strain.item() > 1e-4
    size = np.abs(ours.deflection).max().item()
    assert both.deflection.values == pytest.approx(ours.deflection.values, abs=1e-6 * size)
    for name in (*ALONE, "plastic_dissipation", "energy_error"):
        assert both[name].item() == pytest.approx(ours[name].item(), rel=1e-5, nan_ok=True), name


@OPTION
def test_energy_is_balanced_over_all_spheres(option):
    """To an error that falls with the time step; with prestress it does so to first order."""
    impact, grid = optional(option, further_spheres="0.75 5 0, 0.5 4 1e-4")
    errors, _ = energy_errors(impact, grid, "10 ms")
    assert 2.5 * errors[1] < errors[0] < 3e-3


@BEAMS
def test_the_blows_move_a_free_beam(model, scheme):
    """Its centre is where the forces moved it, of which one acts on an end."""
    impact = replace(held("free", "free", 0.25, il.paper_impact(5.0)), gravity=0.0)
    impact, grid = replace(impact, beam_model=model), replace(GRID, scheme=scheme)
    blows = [
        {"strike_position": 1.0, "velocity": 2.0, "delay": "0.13 ms"},
        {"strike_position": 0.6, "velocity": 4.0},
    ]
    run = il.simulate(replace(impact, further_spheres=blows), grid, duration="1 ms", samples=4001)
    integral = simpson if scheme == "modal" else np.trapezoid  # of modes, or of masses at nodes
    moved = impact.beam.mass_per_length * integral(run.deflection.values, x=run.x.values)
    forces = run.contact_force_of_spheres
    driven = (forces * (1e-3 - run.time)).integrate("time").values
    assert (driven > 0.05 * driven.max()).all()
    assert moved == pytest.approx(driven.sum(), rel=1e-4)
    assert forces.integrate("time").values == pytest.approx(run.impulse_of_spheres.values, rel=1e-4)


_RAYLEIGH = {"mass_damping": 600.0, "stiffness_damping": 1e-6, "foundation_stiffness": 1e8}


@pytest.mark.parametrize(
    ("changes", "scheme", "beam"),
    [
        ({}, "leapfrog", {}),
        ({}, "leapfrog", _RAYLEIGH),
        ({"beam_model": "timoshenko"}, "leapfrog", {}),
        ({"beam_model": "timoshenko"}, "leapfrog", _RAYLEIGH),
        ({"beam_model": "von_karman"}, "leapfrog", {}),
        ({}, "modal", {}),
        ({}, "modal", {"damping_ratio": 0.03, "foundation_stiffness": 1e8}),
        ({"contact": "hunt_crossley"}, "leapfrog", {}),
    ],
)
@pytest.mark.filterwarnings("ignore::impactlab.ImplausibleWarning")
def test_energy_is_balanced_where_the_beam_yields_and_is_damped(changes, scheme, beam):
    """To an error that falls with the time step: a term left out would stay."""
    hard = with_beam_material(
        il.paper_impact(15.0), isotropic_hardening_modulus=2e9, kinematic_hardening_modulus=2e9
    )
    impact = replace(held("clamped", "free", 0.25, hard), further_spheres="1 8 3.1e-4, 0.5 15 1e-4")
    impact = replace(impact, beam=replace(impact.beam, **beam), **changes)
    grid = replace(GRID, scheme=scheme)
    errors, run = energy_errors(impact, grid, "2 ms")
    assert run.plastic_dissipation.item() > 1.0
    assert 4.0 * errors[1] < errors[0] < 3e-3


def test_the_time_step_is_for_the_contacts_that_come():
    """One may take the energy of all; one at a free end pushes half a spacing."""
    impact = replace(held("pinned", "free", 0.25, PAPER), velocity=3.0)
    impact = replace(impact, further_spheres="0.5 4 0, 0.75 12 5e-4, 1 9 2e-3")
    for duration, velocity, further, place in ((1e-3, 13.0, 2, 0.25), (3e-3, 250.0**0.5, 3, 0.0)):
        (fastest,) = make_table(case_table(impact, GRID, duration=duration), 0).fastest
        assert fastest["velocity"] == pytest.approx(velocity)
        assert (fastest["further"], fastest["strike_position"]) == (further, place)


def test_the_modal_scheme_and_leapfrog_converge_to_each_other():
    impact = held("clamped", "pinned", 0.25, il.paper_impact(2.0))
    impact = replace(impact, beam_model="elastic", further_spheres="0.75 3 1e-4, 0.5 1 2.5e-4")
    distances = []
    for nodes in (21, 41, 81):
        grids = [il.Discretisation(nodes=nodes, scheme=scheme) for scheme in ("modal", "leapfrog")]
        runs = [il.simulate(impact, grid, duration="0.8 ms", samples=401) for grid in grids]
        modal, leapfrog = (run.contact_force_of_spheres.values for run in runs)
        distances.append(np.abs(modal - leapfrog).mean() / leapfrog.max())
    assert distances[0] > 2.5 * distances[1] > 6.0 * distances[2]


def test_spheres_exchange_their_roles():
    """However little energy the first one brings: the audit is over that of all."""
    slow = replace(PAPER, velocity=0.05, further_spheres="0.75 10 0")
    fast = replace(PAPER, velocity=10.0, strike_position=0.75, further_spheres="0.25 0.05 0")
    runs = [il.simulate(impact, GRID, duration="1 ms", samples=51) for impact in (slow, fast)]
    forces = [run.contact_force_of_spheres.values for run in runs]
    assert forces[0].max(axis=1).min() > 1e4
    assert forces[0][::-1] == pytest.approx(forces[1], rel=1e-9)
    assert runs[0].energy_error.item() == pytest.approx(runs[1].energy_error.item(), rel=1e-6)


def waves(beam, model, number):
    """Frequencies and shares of a force, of each half sine wave of a pinned beam.

    Timoshenko's has two frequencies per wave: of w = W sin(kx), psi = P cos(kx).
    """
    k, mu = np.arange(1, number) * np.pi / beam.span, beam.mass_per_length
    if model != "timoshenko":
        return k, np.sqrt(beam.bending_stiffness / mu)[np.newaxis] * k[:, None] ** 2, 1.0 / mu
    metal = beam.material
    shear = 0.5 * metal.youngs_modulus / (1.0 + metal.poissons_ratio)
    shear *= beam.shear_correction * beam.width * beam.depth
    turn = np.sqrt(mu), np.sqrt(beam.section.rotary_inertia(metal.density))
    matrices = np.empty((k.size, 2, 2))
    matrices[:, 0, 0] = shear * k**2 / turn[0] ** 2
    matrices[:, 1, 1] = (beam.bending_stiffness * k**2 + shear) / turn[1] ** 2
    matrices[:, 0, 1] = matrices[:, 1, 0] = -shear * k / (turn[0] * turn[1])
    squares, vectors = np.linalg.eigh(matrices)
    return k, np.sqrt(squares), vectors[:, 0] ** 2 / mu


@pytest.mark.parametrize(
    ("model", "scheme"),
    [
        *((model, "leapfrog") for model in ("elastic", "timoshenko", "von_karman")),
        ("euler_bernoulli", "modal"),
        ("euler_bernoulli", "leapfrog"),
    ],
)
def test_blows_superpose(model, scheme):
    """The modal series of an elastic beam under both forces; the second does as it does alone."""
    small = replace(PAPER, velocity=0.1, strike_position=0.1, beam_model=model)
    delay, duration, place = 0.0987e-3, 0.5e-3, 0.8
    grid = il.Discretisation(nodes=101, scheme=scheme)
    blow = {"strike_position": place, "velocity": 0.5, "delay": delay}
    run = il.simulate(replace(small, further_spheres=[blow]), grid, duration=duration, samples=4001)
    alone = replace(small, strike_position=place, velocity=0.5)
    single = il.simulate(alone, grid, duration=duration - delay, samples=2)
    for name in ALONE:
        second = run[f"{name}_of_spheres"].values[1]
        assert second == pytest.approx(single[name].item(), rel=3e-3), name
    t, span = run.time.values, small.beam.span
    k, omega, shares = waves(small.beam, model, 60)
    q = 0.0
    for x, force in zip((0.1, place), run.contact_force_of_spheres.values, strict=True):
        pushes = np.sin(omega[..., None] * (duration - t)) * force
        driven = np.trapezoid(pushes, t, axis=-1) * shares / omega
        q = q + np.sin(k * x * span) * driven.sum(axis=1)
    w = np.sin(k[:, None] * run.x.values).T @ q / (0.5 * span)
    assert run.deflection.values == pytest.approx(w, abs=2e-3 * np.abs(w).max())


def test_spheres_exchange_their_roles_with_kinks_circles_and_dents():
    """The first sphere is moved by the time loop, a further one as a part of the beam."""
    slow, grid = optional("all", further_spheres="0.75 5 0, 0.4 3 0")
    fast = replace(slow, strike_position=0.75, further_spheres="0.25 5 0, 0.4 3 0")
    last = replace(slow, strike_position=0.4, velocity=3.0, further_spheres="0.25 5 0, 0.75 5 0")
    runs = [il.simulate(impact, grid, duration="10 ms") for impact in (slow, fast, last)]
    for name in ("peak_force", "impulse", "permanent_indentation"):
        first, second, third = (run[f"{name}_of_spheres"].values for run in runs)
        assert second[[1, 0, 2]] == pytest.approx(first, rel=1e-5), name
        assert third[[1, 2, 0]] == pytest.approx(first, rel=1e-5), name
    assert runs[1].deflection.values == pytest.approx(runs[0].deflection.values, rel=1e-4, abs=1e-9)
    assert runs[2].deflection.values == pytest.approx(runs[0].deflection.values, rel=1e-4, abs=1e-9)


@pytest.mark.parametrize(
    "option", ["prestress", "compliance", "strip", "patch", "patch on the strip"]
)
def test_a_later_sphere_far_away_does_as_it_does_alone(option):
    """It comes before waves of the first."""
    impact, grid = optional(option, velocity=8.0)
    impact, grid = replace(impact, strike_position=0.7), replace(grid, nodes=101)
    both = replace(impact, strike_position=0.15, velocity=0.1, further_spheres="0.7 8 2e-5")
    single = il.simulate(impact, grid, duration="0.4 ms", samples=2)
    run = il.simulate(both, grid, duration="0.42 ms", samples=2)
    for name in ALONE:
        second = run[f"{name}_of_spheres"].values[1]
        assert second == pytest.approx(single[name].item(), rel=3e-3), name


def test_dents_of_every_place_are_carried_over_and_grow_less_and_less():
    impact, grid = optional("strikes", further_spheres="0.75 5 0, 0.5 4 1e-4")
    runs = [
        il.simulate(replace(impact, strikes=strikes), grid, duration="10 ms", samples=2)
        for strikes in (1, 2, 3)
    ]
    dents = np.array([run.permanent_indentation_of_spheres.values for run in runs])
    growth = np.diff(dents, axis=0)
    assert (growth[0] > 0.02 * dents[0]).all()
    assert (growth[0] > growth[1]).all()
    assert (growth[1] > 0.0).all()
    series = runs[2].permanent_indentation_over_strikes.values
    assert series == pytest.approx(dents[:, 0], rel=1e-4)  # steps are for the hardest strike


def test_a_volley_waits_until_all_spheres_have_left():
    impact, grid = optional("strikes", further_spheres="0.75 5 9.9e-3")
    run = il.simulate(impact, grid, duration="10 ms", samples=2)
    assert (run.status_of_spheres.values == 512).all()


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
