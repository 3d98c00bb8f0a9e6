"""Rayleigh's damping of the 3-D model: free decay, balance, limits of the step, and a beam's."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse.linalg import eigsh
from solid_matrices import matrices

import impactlab as il
from impactlab.fem3d.solver import estimate, impact_mesh, solve, solve_on
from impactlab.fem3d.solver.estimates import damped_step
from impactlab.fem3d.solver.march import SAFETY
from impactlab.fem3d.solver.mesh import SPHERE
from impactlab.fem3d.solver.system import System, ThreadPool, critical_step

PAPER = il.paper_impact()
SIZES = {"element_size": 5e-3, "patch": 5e-3, "ratio": 3.0, "coarsest": 20e-3}
SHORT = {"element_size": 3e-3, "ratio": 2.0, "coarsest": 14e-3}


def damped(beam, **values):
    return replace(PAPER, beam=replace(beam, **values), beam_model="solid", gravity=0.0)


@pytest.mark.parametrize(("alpha", "beta"), [(3e3, 0.0), (0.0, 1e-6), (1.5e3, 0.7e-6)])
def test_the_first_mode_decays_and_swings_as_an_oscillator_does(alpha, beta):
    """Ends on springs, which the stiffness's damping damps, too."""
    ends = {"stiffness_left": 1e9, "stiffness_right": 1e9} | dict.fromkeys(
        ("support_left", "support_right"), "elastic"
    )
    beam = replace(PAPER.beam, span=0.12, width=0.02, depth=0.02, **ends)
    impact = damped(beam, mass_damping=alpha, stiffness_damping=beta)
    mesh = impact_mesh(impact, **SIZES)
    stiffness, mass, (nodes, axes) = matrices(impact, mesh)
    squares, shapes = eigsh(stiffness, 3, mass, sigma=-1e6)
    first = np.flatnonzero(squares > 1e6)[0]  # nothing holds the axis
    omega, shape = float(np.sqrt(squares[first])), shapes[:, first]
    zeta = 0.5 * (alpha / omega + beta * omega)
    swing = omega * np.sqrt(1.0 - zeta**2)
    with ThreadPool(1) as pool:
        system = System(mesh, impact, pool)
        system.v[:] = 0.0
        system.x[np.unique(mesh.elements[mesh.body == SPHERE]), 2] += 1.0
        dt = 0.25 * damped_step(critical_step(system), beta)
        system.v[nodes, axes] = 1e-3 * shape
        times = dt * np.arange(1, int(6.0 * np.pi / omega / dt))
        moved = np.empty_like(times)
        for step in range(times.size):
            system.move(0.0 if step == 0 else dt, dt)
            moved[step] = mass.diagonal() @ (shape * (system.x - mesh.nodes)[nodes, axes])
            system.strain(dt)
            system.drag(dt)
    # the motion begins half a step before the first velocity
    exact = np.exp(-zeta * omega * times) * np.sin(swing * times) / swing
    exact *= moved[0] / exact[0]
    assert 0.005 < zeta < 0.2
    late = times > 4.0 * np.pi / omega
    assert np.abs(moved - exact)[late].max() < 2e-3 * np.abs(exact)[late].max()


RESISTED = [
    {"mass_damping": 2e3},
    {"stiffness_damping": 3e-7},
    {"mass_damping": 1e3, "stiffness_damping": 1e-7, "foundation_stiffness": 1e9},
]


@pytest.mark.parametrize("values", RESISTED)
def test_the_balance_of_energy_counts_what_damping_takes(values):
    beam = replace(PAPER.beam, span=0.2, support_left="clamped", rotational_stiffness_right=1e5)
    beam = replace(beam, support_right="elastic", stiffness_right=1e8)
    impact = replace(damped(beam, **values), velocity=4.0, strike_position=0.4)
    run = solve_on(impact_mesh(impact, **SHORT), impact, duration=1.5e-4)
    first = 0.5 * impact.sphere.total_mass * impact.velocity**2
    assert float(run["plastic_work"][-1]) > 0.01 * first
    assert float(run["damping_work"][-1]) > 0.02 * first
    assert (np.diff(run["damping_work"]) >= 0.0).all()
    assert float(run["energy_error"]) < 1e-5


@pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")
@pytest.mark.filterwarnings("ignore::impactlab.ImplausibleWarning")
def test_damping_of_the_mass_changes_an_impact_as_it_does_the_beam_models():
    """Damping of the stiffness is that of the metal in the dent, too, which no beam model has."""
    names = ["peak_force", "contact_duration", "impulse", "maximum_deflection"]
    base = replace(il.corrected_impact(0.99), contact_prestress="ignored", load="point")
    base = replace(base, contact_compliance="beam", beam=replace(base.beam, span=0.3))
    changes = []
    for model in ("timoshenko", "solid"):
        rows = []
        for alpha in (0.0, 3e3):
            impact = replace(base, beam=replace(base.beam, mass_damping=alpha))
            if model == "solid":
                run = solve(impact, element_size=2e-3, duration=5e-4)
            else:
                run = il.simulate(impact, il.Discretisation(nodes=101), duration=5e-4)
            rows.append([float(run[name]) for name in names])
        changes.append(np.divide(*rows[::-1]) - 1.0)
    assert changes[0][3] < -0.3
    assert changes[0][2] > 0.05
    np.testing.assert_allclose(changes[1], changes[0], atol=3e-3)


def test_damping_of_the_stiffness_shortens_the_steps_to_what_is_stable():
    beta = 3e-7
    impact = damped(replace(PAPER.beam, span=0.12, width=0.02, depth=0.02), stiffness_damping=beta)
    mesh = impact_mesh(impact, **SIZES)
    with ThreadPool(1) as pool:
        undamped = critical_step(System(mesh, impact, pool))
        limit = damped_step(undamped, beta)
        assert limit * (limit + 2.0 * beta) == pytest.approx(undamped**2, rel=1e-12)
        grown = []
        for share in (0.97, 1.05):
            system, dt = System(mesh, impact, pool), share * limit
            ball = np.unique(mesh.elements[mesh.body == SPHERE])
            system.v[:] = 1e-6 * np.random.default_rng(1).standard_normal(system.v.shape)
            system.v *= system.inverse_mass > 0.0
            system.v[ball] = 0.0
            system.x[ball, 2] += 1.0
            for _ in range(400):
                system.move(dt, dt)
                system.strain(dt)
                system.drag(dt)
            grown.append(np.abs(system.v).max() / 1e-6)
    assert grown[0] < 3.0
    assert grown[1] > 100.0
    steps = estimate(mesh, impact, duration=1e-4).steps
    assert 1.0 < steps * damped_step(SAFETY * undamped, beta) / 1e-4 < 1.3


def test_a_damped_run_has_the_same_bits_on_any_number_of_threads():
    impact = damped(PAPER.beam, mass_damping=1e3, stiffness_damping=1e-7)
    mesh = impact_mesh(impact, element_size=4e-3)
    runs = [solve_on(mesh, impact, duration=1e-5, threads=threads) for threads in (1, 3)]
    np.testing.assert_array_equal(runs[0]["displacement"], runs[1]["displacement"])
    assert runs[0]["damping_work"][-1] == runs[1]["damping_work"][-1] > 0.0
