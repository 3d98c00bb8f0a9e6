"""Springs of the 3-D model, of ends and foundation: as stiff as a beam's, balanced, with limits."""

from dataclasses import replace

import numpy as np
import pytest
from end_modes import sprung_roots
from scipy.sparse.linalg import eigsh, spsolve
from solid_matrices import matrices

import impactlab as il
from impactlab.fem3d.solver import estimate, impact_mesh, solve_on
from impactlab.fem3d.solver.march import SAFETY
from impactlab.fem3d.solver.mesh import check_mesh
from impactlab.fem3d.solver.springs import springs_of
from impactlab.fem3d.solver.system import System, ThreadPool, critical_step

PAPER = il.paper_impact()
SLENDER = replace(PAPER.beam, span=0.5, width=0.02, depth=0.02)
SIZES = {"element_size": 5e-3, "patch": 5e-3, "ratio": 3.0, "coarsest": 20e-3}
SPRINGS = {  # of the left end and of the right one: k_t L^3/EI and k_r L/EI; k L^4/EI beneath
    "ends alike": ((300.0, 20.0), (300.0, 20.0), 0.0),
    "ends unlike": ((200.0, 0.0), (50.0, 8.0), 0.0),
    "against deflection alone": ((60.0, 0.0), (60.0, 0.0), 0.0),
    "foundation": ((0.0, 0.0), (0.0, 0.0), 400.0),
    "all": ((80.0, 5.0), (200.0, 0.0), 300.0),
}


def on_springs(left, right, bed=0.0, beam=SLENDER, **values):
    """Return an impact on a beam whose springs are over EI and span."""
    EI, span = beam.bending_stiffness, beam.span
    sides = {}
    for side, (shear, turn) in {"left": left, "right": right}.items():
        sides[f"support_{side}"] = "elastic" if shear + turn > 0.0 else "free"
        sides[f"stiffness_{side}"] = shear * EI / span**3
        sides[f"rotational_stiffness_{side}"] = turn * EI / span
    beam = replace(beam, **sides, foundation_stiffness=bed * EI / span**4)
    return replace(PAPER, beam=beam, beam_model="solid", **values)


def lowest(impact, number):
    """Return the lowest squares of frequencies, in rad2/s2, of motions with bending."""
    stiffness, mass, _ = matrices(impact, impact_mesh(impact, **SIZES))
    near = -((2.0 * np.pi * 10.0) ** 2)
    squares = np.sort(eigsh(stiffness, number + 3, mass, sigma=near, return_eigenvectors=False))
    return squares[squares > 1e-4 * squares[-1]][:number]


@pytest.mark.parametrize("springs", SPRINGS.values(), ids=SPRINGS.keys())
def test_the_lowest_frequencies_are_those_of_the_characteristic_equation(springs):
    left, right, bed = springs
    flies = bed > 0.0 and left == right == (0.0, 0.0)  # and rises and turns before it bends
    fourth = np.zeros(2) if flies else sprung_roots((left, right), 2) ** 4
    EI, mass = SLENDER.bending_stiffness, SLENDER.mass_per_length
    exact = np.sqrt((fourth + bed) * EI / (mass * SLENDER.span**4))
    squares = lowest(on_springs(*springs, strike_position=0.4), 2)
    assert np.sqrt(squares) == pytest.approx(exact, rel=0.006)


def beam_deflection(left, right, place):
    """Return the deflection under a unit force at `place`, of a beam of EI = span = 1 on springs.

    Two Hermite elements, which are exact between forces.
    """
    stiffness = np.zeros((6, 6))
    for first, h in ((0, place), (2, 1.0 - place)):
        rows = np.array([[12, 6 * h, -12, 6 * h], [6 * h, 4 * h * h, -6 * h, 2 * h * h]])
        lower = np.array([[-12, -6 * h, 12, -6 * h], [6 * h, 2 * h * h, -6 * h, 4 * h * h]])
        stiffness[first : first + 4, first : first + 4] += np.vstack([rows, lower]) / h**3
    stiffness += np.diag([*left, 0.0, 0.0, *right])
    return np.linalg.solve(stiffness, np.eye(6)[2])[2]


@pytest.mark.parametrize("springs", [*SPRINGS.values()][:4])
def test_deflections_under_a_steady_force_are_those_of_the_beam(springs):
    """With the shear of ends that do not sink; without, 0.3 % on a foundation (Hetenyi)."""
    left, right, bed = springs
    place = 0.5 if bed else 0.4
    impact = on_springs(*springs, strike_position=place)
    mesh, beam = impact_mesh(impact, **SIZES), impact.beam
    stiffness, mass, (nodes, axes) = matrices(impact, mesh)
    struck = (np.abs(mesh.nodes[nodes, 0]) < 1e-9) & (axes == 2)
    force = np.where(struck, mass.diagonal(), 0.0)
    force /= mesh.copies * force.sum()
    if left[1] + right[1] == 0.0:  # nothing holds the axis
        stiffness = stiffness + 1.0 * mass
    w = spsolve(stiffness.tocsc(), force)
    EI, span, steel = beam.bending_stiffness, beam.span, beam.material
    if bed:
        length = (bed / 4.0) ** 0.25
        sinh, cosh, sine, cosine = np.sinh(length), np.cosh(length), np.sin(length), np.cos(length)
        exact = 0.5 * length / bed * (cosh + cosine + 2.0) / (sinh + sine) * span**3 / EI
    else:
        shear = 5 / 6 * steel.youngs_modulus / 2.6 * beam.width * beam.depth
        exact = beam_deflection(left, right, place) * span**3 / EI
        exact += place * (1.0 - place) * span / shear
    deflection = w[(nodes == mesh.axis_node) & (axes == 2)].item()
    assert deflection == pytest.approx(exact, rel=0.006)


def test_the_springs_of_an_end_sum_to_those_of_the_beam():
    """A rotation about mid-depth causes a moment and no force, a deflection a force alone."""
    impact = on_springs((300.0, 20.0), (50.0, 8.0), 400.0, strike_position=0.4)
    mesh, beam = impact_mesh(impact, **SIZES), impact.beam
    nodes, axes, stiffness = springs_of(mesh, impact)
    x, _, z = mesh.nodes[nodes].T
    height = z + 0.5 * beam.depth
    for side, place in (("left", -0.4 * beam.span), ("right", 0.6 * beam.span)):
        end, turned = np.abs(x - place) < 1e-9, axes == 0
        along, line = end & turned, end & ~turned & (np.abs(height) < 1e-9)
        moment = 2.0 * stiffness[along] @ height[along] ** 2
        assert moment == pytest.approx(getattr(beam, f"rotational_stiffness_{side}"), rel=1e-12)
        assert abs(stiffness[along] @ height[along]) < 1e-12 * moment / beam.depth
        sunk = 2.0 * stiffness[line].sum()
        assert sunk == pytest.approx(getattr(beam, f"stiffness_{side}"), rel=1e-12)
    beneath = np.abs(z + beam.depth) < 1e-9
    bed = 2.0 * stiffness[beneath & (axes == 2)].sum() / beam.span
    assert bed == pytest.approx(beam.foundation_stiffness, rel=1e-12)


def test_very_stiff_springs_hold_as_hinges_and_clamps_do():
    """A clamped face can neither contract nor warp: its beam is stiffer by two percent."""
    stiff = 1e7
    for turn, ends, share in ((0.0, "pinned", 1.0), (stiff, "clamped", 0.98)):
        impact = on_springs((stiff, turn), (stiff, turn), strike_position=0.4)
        sides = {"support_left": ends, "support_right": ends}
        held = replace(impact, beam=replace(impact.beam, **sides))
        assert lowest(impact, 2) / lowest(held, 2) == pytest.approx(share, abs=5e-3)


def test_a_run_on_springs_keeps_its_energy_and_without_stiffness_has_the_same_bits():
    sizes = {"element_size": 3e-3, "ratio": 2.0, "coarsest": 14e-3}
    beam = replace(PAPER.beam, span=0.3)
    springs = (20.0, 2.0), (50.0, 0.0), 300.0
    impact = on_springs(*springs, beam=beam, strike_position=0.3, velocity=5.0)
    run = solve_on(impact_mesh(impact, **sizes), impact, duration=3e-4)
    first = 0.5 * impact.sphere.total_mass * impact.velocity**2
    assert float(run["energy_error"]) < 1e-4
    assert float(run["spring_energy"].max()) > 0.02 * first
    free = on_springs((0.0, 0.0), (0.0, 0.0), beam=beam, velocity=5.0)
    none = replace(free.beam, foundation_stiffness=0.0, stiffness_left=1e7)
    runs = [
        solve_on(impact_mesh(each, **sizes), each, duration=2e-5)
        for each in (free, replace(free, beam=none))
    ]
    np.testing.assert_array_equal(runs[0]["contact_force"], runs[1]["contact_force"])
    assert not runs[0]["spring_energy"].any()


@pytest.mark.parametrize("springs", [((1e6, 1e6), (0.0, 0.0), 0.0), ((0.0, 0.0), (0.0, 0.0), 1e11)])
def test_stiff_springs_shorten_the_steps_and_raise_the_estimate(springs):
    impact = on_springs(*springs)
    mesh = impact_mesh(impact, **SIZES)
    stiffness, mass, _ = matrices(impact, mesh)
    (largest,) = eigsh(stiffness, 1, mass, which="LM", return_eigenvectors=False)
    with ThreadPool(1) as pool:
        step = critical_step(System(mesh, impact, pool))
    assert step == pytest.approx(2.0 / np.sqrt(largest), rel=0.02)
    with ThreadPool(1) as pool:
        soft = System(mesh, on_springs((1.0, 1.0), (0.0, 0.0)), pool)
        assert critical_step(soft) > 1.5 * step
    steps = 1e-4 / (SAFETY * step)
    assert steps < estimate(mesh, impact, duration=1e-4).steps < 1.3 * steps


def test_a_quarter_is_refused_where_springs_differ():
    alike, unlike = (on_springs((300.0, 20.0), (right, 20.0)) for right in (300.0, 200.0))
    mesh = impact_mesh(alike, **SIZES)
    assert (mesh.copies, impact_mesh(unlike, **SIZES).copies) == (4, 2)
    with pytest.raises(ValueError, match="the mesh is a quarter, but the springs"):
        check_mesh(mesh, unlike)
