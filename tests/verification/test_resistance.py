"""Damped beams, on a foundation: free vibration, published deflections, energy, order, limits."""

import itertools
import warnings
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import least_squares

import impactlab as il
from impactlab.model.beam_modes import mode_table
from impactlab.model.case_table import case_table
from impactlab.solve import fibre_section
from impactlab.solver import resisted_modes
from impactlab.solver.beam import copies
from impactlab.solver.contact.history import make_pair
from impactlab.solver.fibre_plasticity import make_plastic_state
from impactlab.solver.modal import begin_flight
from impactlab.solver.modes import add_moment
from impactlab.solver.stability import discretise

from ..end_modes import roots

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")

RAYLEIGH = {"mass_damping": 60.0, "stiffness_damping": 1e-5}
KINDS = [
    ("leapfrog", {"mass_damping": 60.0}),
    ("leapfrog", {"stiffness_damping": 1e-5}),
    ("modal", RAYLEIGH),
    ("modal", {"damping_ratio": 0.02}),
    ("leapfrog", {"foundation_stiffness": 3e7, "stiffness_damping": 1e-5}),
    ("modal", {"foundation_stiffness": 3e7, "damping_ratio": 0.02}),
]


def resisted(velocity=0.5, beam_model="elastic", load="point", radius=0.01, **values):
    impact = il.paper_impact(velocity, "hertz")
    sphere = replace(impact.sphere, radius=radius)
    beam = replace(impact.beam, **values)
    return replace(impact, sphere=sphere, beam=beam, beam_model=beam_model, load=load)


def observed(impact, scheme, nodes, shapes, expected):
    """Return decay rates and frequencies (1/s) of modes that vibrate freely after a strike.

    shapes: functions of the place over the span. expected: (decay, frequency) of each, to start at.
    """
    grid = il.Discretisation(nodes=nodes, scheme=scheme)
    run = il.simulate(impact, grid, duration=6e-3, frames=25)
    assert run.number_of_contacts.item() == 1
    assert run.contact_duration.item() < 2e-4
    times, rates = run.field_time.values[2:], []
    for shape, start in zip(shapes, expected, strict=True):
        places = run.x.values / impact.beam.span
        q = (run.deflection_over_time.values @ shape(places))[2:]

        def residual(factors, q=q, start=start):
            decay, turn = factors * start
            waves = np.exp(-decay * times) * np.stack([np.cos(turn * times), np.sin(turn * times)])
            return (q - waves.T @ np.linalg.lstsq(waves.T, q, rcond=None)[0]) / np.abs(q).max()

        rates.append(start * least_squares(residual, [1.02, 1.01], xtol=1e-13, ftol=1e-13).x)
    return np.array(rates).T


@pytest.mark.parametrize(("scheme", "values"), KINDS)
def test_free_vibration_has_the_logarithmic_decrement(scheme, values):
    """decay = zeta omega, of two modes; zeta = alpha/(2 omega) + beta omega/2 + ratio."""
    impact = resisted(**values)
    beam, n = impact.beam, np.array([1, 3])
    k = n * np.pi / beam.span
    k2 = k**2 if scheme == "modal" else (2 * 100 / beam.span * np.sin(k * beam.span / 200)) ** 2
    stiffness = beam.bending_stiffness * k2**2 + beam.foundation_stiffness
    omega = np.sqrt(stiffness / beam.mass_per_length)
    zeta = beam.mass_damping / (2 * omega) + beam.stiffness_damping * omega / 2
    zeta += beam.damping_ratio
    expected = zeta * omega, omega * np.sqrt(1 - zeta**2)
    shapes = [lambda x, n=n: np.sin(n * np.pi * x) for n in (1, 3)]
    nodes, rel = (101, 1e-3) if scheme == "leapfrog" else (21, 1e-7)
    ours = observed(impact, scheme, nodes, shapes, np.transpose(expected))
    assert ours == pytest.approx(np.array(expected), rel=rel)


SDNL32 = {  # N/m: mm at 1 to 12 ms
    18e3: "-2.66 -4.33 -4.92 -4.78 -3.82 -2.87 -2.71 -3.09 -3.41 -3.36 -2.64 -.742",
    45e3: "-2.25 -2.66 -1.96 -1.15 -.124 -.364 -2.01 -2.74 -1.89 -.352 1.70 4.99",
}


@pytest.mark.parametrize("stiffness", SDNL32)
def test_a_turning_beam_on_an_elastic_stop_is_as_published(stiffness):
    """Code_Aster V5.01.032 (SDNL32): pinned-free, -3.8 rad/s, 1 % of critical, stop at the tip.

    Seen from the turning beam, the tip is struck by a body that nothing slows down.
    """
    metal = replace(il.paper_impact().beam.material, youngs_modulus=67e9, density=2400.0)
    size = {"span": 0.783, "width": 0.014, "depth": 0.014, "material": metal}
    held = {"support_right": "free", "place": 1.0, "damping_ratio": 0.01}
    _, grid, steps, modes = modal_steps(duration=12e-3, **size, **held)
    turned, deflection = 3.8 * 0.783 * grid.dt * np.arange(steps + 1), np.zeros(steps + 1)
    for step in range(steps):
        force = stiffness * max(turned[step] - deflection[step], 0.0)
        deflection[step + 1] = resisted_modes.move_damped(*modes[:4], force)
    times = np.arange(steps + 1) * grid.dt
    tip = 1e3 * np.interp(np.arange(1, 13) * 1e-3, times, deflection - turned)
    published = np.array([float(value) for value in SDNL32[stiffness].split()])
    assert tip == pytest.approx(published, rel=0, abs=0.01 * np.abs(published).max())


@pytest.mark.parametrize("load", ["point", "contact_patch"])
@pytest.mark.parametrize("ends", [{}, {"support_left": "clamped", "support_right": "free"}])
@pytest.mark.parametrize("scheme", ["leapfrog", "modal"])
@pytest.mark.parametrize(("model", "velocity"), [("elastic", 1.0), ("euler_bernoulli", 10.0)])
def test_the_balance_of_energy_counts_what_damping_takes(model, velocity, scheme, ends, load):
    """The error is no more than that of an undamped run, though damping takes much."""
    grid = il.Discretisation(nodes=65, points=9, scheme=scheme)
    runs = [
        il.simulate(resisted(velocity, model, load, 0.035, **values, **ends), grid, duration=4e-3)
        for values in (
            {},
            {"mass_damping": 200.0, "stiffness_damping": 2e-5, "foundation_stiffness": 1e7},
        )
    ]
    limit = 1e-6 if scheme == "leapfrog" else 1.1 * runs[0].energy_error.item()
    assert runs[1].energy_error.item() < limit  # leapfrog's steps are short
    lower = [np.abs(run.midspan_deflection[-400:]).max().item() for run in runs]
    assert lower[1] < 0.9 * lower[0]


@pytest.mark.parametrize(
    ("scheme", "values"), [("leapfrog", {**RAYLEIGH, "foundation_stiffness": 3e7}), *KINDS[2:4]]
)
def test_deflections_converge_at_second_order(scheme, values):
    impact, nodes = resisted(1.0, radius=0.035, **values), (51, 101, 201)
    nodes = nodes if scheme == "leapfrog" else (21, 41, 81)
    histories = []
    for count in nodes:
        grid = il.Discretisation(nodes=count, scheme=scheme, courant=0.5)
        run = il.simulate(impact, grid, duration=1e-3, samples=401)
        histories.append(run.midspan_deflection.values)
    coarse, fine = (np.abs(b - a).max() for a, b in itertools.pairwise(histories))
    assert 3.3 < coarse / fine < 5.0


@pytest.mark.parametrize(
    ("model", "scheme"),
    [("euler_bernoulli", "leapfrog"), ("euler_bernoulli", "modal"), ("timoshenko", "leapfrog")],
)
def test_vanishing_resistance_changes_nothing(model, scheme):
    grid = il.Discretisation(nodes=41, points=9, scheme=scheme)
    runs = [
        il.simulate(resisted(12.0, model, "contact_patch", 0.035, **values), grid, duration=4e-3)
        for values in ({}, {"mass_damping": 1e-9}, {"foundation_stiffness": 1e-3})
    ]
    for name in ("peak_force", "impulse", "plastic_dissipation", "maximum_deflection"):
        plain, *others = (run[name].item() for run in runs)
        assert others == pytest.approx([plain, plain], rel=1e-6)


def test_an_overdamped_mode_turns_as_its_two_real_roots():
    for theta, r in ((0.3, 0.1), (0.3, 0.3), (0.3, 2.0), (1e-6, 5.0)):
        root = np.sqrt(complex(r * r - theta * theta))
        exact = (1 - np.exp(-r - root)) * (1 - np.exp(-r + root))
        assert resisted_modes.damped_turn(theta, r) == pytest.approx(exact.real, rel=1e-4)


def modal_steps(nodes=21, duration=1e-3, **values):
    """Return case, grid, number of steps and modes of a beam at rest."""
    impact = resisted(**{name: value for name, value in values.items() if name != "place"})
    impact = replace(impact, strike_position=values.get("place", 0.5))
    discretisation = il.Discretisation(nodes=nodes, scheme="modal", courant=0.05)
    case = case_table(impact, discretisation, duration=duration)[0]
    section = fibre_section(case)
    grid, steps = discretise(case, make_pair(case), section)
    modes = resisted_modes.make(case, section, grid)
    resisted_modes.take(modes, mode_table(case))
    resisted_modes.renew(modes, case, section, grid)
    return case, grid, steps, modes


@pytest.mark.parametrize("ends", ["pinned", "free"])
@pytest.mark.parametrize("length", [0.5, 4.0, 20.0])
def test_modes_on_a_foundation_sum_to_the_closed_form(ends, length):
    """Their static deflection under a force at mid-span, and each frequency.

    length: of the beam, times the root of k/(4 EI). Hetenyi, Beams on elastic foundation (1946),
    of which the long beam's deflection has the limit P beta/(2 k).
    """
    beam = il.paper_impact().beam
    beta = length / beam.span
    k = 4.0 * beam.bending_stiffness * beta**4
    sides = {"support_left": ends, "support_right": ends}
    _, grid, _, (modes, *_) = modal_steps(foundation_stiffness=k, **sides)
    sinh, cosh, sine, cosine = np.sinh(length), np.cosh(length), np.sin(length), np.cos(length)
    exact = (
        (sinh - sine) / (cosh + cosine)
        if ends == "pinned"
        else ((cosh + cosine + 2.0) / (sinh + sine))
    )
    ours = (modes.push / modes.D).sum() / (0.5 * beta / k)
    assert ours == pytest.approx(exact, rel=1e-4 if length > 10 else 1e-7)
    b = roots(ends, ends, 12)[:: 2 if ends == "pinned" else 1][: modes.q.size // 2]
    b = b if ends == "pinned" else np.append(0.0, b[::2])[: modes.q.size // 2]
    square = (beam.bending_stiffness * (b / beam.span) ** 4 + k) / beam.mass_per_length
    omega = 2.0 * np.arcsin(0.5 * np.sqrt(modes.D[: b.size])) / grid.dt
    assert omega == pytest.approx(np.sqrt(square), rel=1e-9)


@pytest.mark.parametrize("ends", ["pinned", "free"])
def test_on_a_foundation_both_schemes_have_one_limit(ends):
    """With sections that yield, in flight, too: leaps are made from the foundation's rest."""
    sides = {"support_left": ends, "support_right": ends, "foundation_stiffness": 2e7}
    impact = resisted(12.0, "euler_bernoulli", radius=0.035, **sides)
    metal = replace(impact.beam.material, isotropic_hardening_modulus=5e9)
    impact = replace(impact, beam=replace(impact.beam, material=metal))
    leapfrog, modal = (
        il.simulate(impact, il.Discretisation(nodes=nodes, points=15, scheme=scheme), duration=6e-3)
        for nodes, scheme in ((401, "leapfrog"), (121, "modal"))
    )
    for name, rel in (("peak_force", 5e-3), ("impulse", 0.02), ("plastic_dissipation", 0.03)):
        assert modal[name].item() == pytest.approx(leapfrog[name].item(), rel=rel)
    size = np.abs(leapfrog.midspan_deflection).max().item()
    difference = modal.midspan_deflection.values - leapfrog.midspan_deflection.values
    assert np.abs(difference).max() < 0.015 * size
    assert leapfrog.energy_error.item() < 1e-3
    assert modal.energy_error.item() < 1e-3
    steps = replace(impact, beam=replace(impact.beam, mass_damping=1e-9))  # which makes no leaps
    single = il.simulate(
        steps, il.Discretisation(nodes=121, points=15, scheme="modal"), duration=6e-3
    )
    for name in ("peak_force", "plastic_dissipation", "maximum_deflection", "impulse"):
        assert modal[name].item() == pytest.approx(single[name].item(), rel=1e-6, nan_ok=True)


def test_leaps_begin_from_the_rest_that_the_foundation_leaves():
    """Plastic moments bend a beam on a foundation by less than M_0/EI: kappa_p = M_p/(EI + k/k^4).

    No section is watched whose elastic interval holds that by a hair; of M_0/EI all would be.
    """
    k = 1e9
    case, grid, _, (modes, *_) = modal_steps(foundation_stiffness=k)
    section, random = fibre_section(case), np.random.default_rng(1)
    plastic = make_plastic_state(grid, section)
    inside = range(2, grid.last + 1)
    lengths = np.array([copies(grid, i) * grid.dx for i in inside])
    moments = random.normal(0.0, 100.0, lengths.size)
    plastic.M_0[2 : grid.last + 1] = moments
    for i, moment, length in zip(inside, moments, lengths, strict=True):
        add_moment(modes.source, modes.bent, i, length * moment)
    modes.q[:], modes.u[:] = modes.push / modes.D * modes.source, 0.0
    waves = (2 * np.arange(lengths.size) + 1) * np.pi / case.beam_span
    shapes = np.cos(np.outer(waves, (grid.mid - np.array(inside)) * grid.dx))
    shares = 2.0 / case.beam_span * shapes @ (lengths * moments)
    rest = (shares / (section.stiffness + k / waves**4)) @ shapes
    plastic.kappa_min[2 : grid.last + 1] = rest - 1e-9 * np.abs(rest).max()
    plastic.kappa_max[2 : grid.last + 1] = rest + 1e-9 * np.abs(rest).max()
    begin_flight(modes, plastic, section.stiffness, grid, False)
    assert modes.leaps.watched[0] == 0
    begin_flight(modes, plastic, section.stiffness, grid, True)
    assert modes.leaps.watched[0] > 0.8 * lengths.size


@pytest.mark.parametrize(
    "values", [{"damping_ratio": 0.3}, {"mass_damping": 1e3}, {"stiffness_damping": 1e-3}]
)
def test_implausible_damping_warns(values):
    grid = il.Discretisation(nodes=9, scheme="modal")
    with pytest.warns(il.ImplausibleWarning, match="metal structures"):
        il.simulate(resisted(**values), grid, duration=1e-5)
    with warnings.catch_warnings():
        warnings.simplefilter("error", il.ImplausibleWarning)
        plausible = {name: 0.1 * value for name, value in values.items()}
        il.simulate(resisted(**plausible), grid, duration=1e-5)
