import time
from dataclasses import replace
from typing import Any

import numba
import numpy as np
import pytest

from impactlab.model.case_table import case_table
from impactlab.model.cost import _BESIDES, _RATES, node_steps, work
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import paper_impact
from impactlab.solve import fibre_section, solve
from impactlab.solver import BEAM_MODELS, SCHEMES
from impactlab.solver.contact.history import make_pair
from impactlab.solver.stability import discretise

PAPER: dict[str, Any] = {
    "beam_span": 0.78,
    "beam_width": 0.06,
    "beam_depth": 0.0278,
    "beam_density": 7800.0,
    "beam_youngs_modulus": 210e9,
    "duration": 1e-3,
    "courant": 0.5,
    "nodes": 201,
    "scheme": SCHEMES.index("leapfrog"),
    "support_left": 0,
    "support_right": 0,
    "stiffness_left": 0.0,
    "stiffness_right": 0.0,
    "rotational_stiffness_left": 0.0,
    "rotational_stiffness_right": 0.0,
    "stiffness_damping": 0.0,
    "strike_position": 0.5,
    "axis_held_left": 1,
    "axis_held_right": 1,
    "strikes": 1,
    "strike_interval": 0.0,
    "further": 0,
    "beam_model": BEAM_MODELS.index("euler_bernoulli"),
}


def test_steps_of_bending_and_of_a_bar_wave_by_hand():
    dx, speed = 0.78 / 200, (210e9 / 7800.0) ** 0.5
    bending = 0.5 * dx**2 / (speed * 0.0278 / 12**0.5)
    assert node_steps(PAPER) == pytest.approx(0.5 * 201 * 1e-3 / (0.5 * bending))
    wave = node_steps(PAPER | {"scheme": SCHEMES.index("modal")})
    assert wave == pytest.approx(0.5 * 201 * 1e-3 / (0.5 * dx / speed))
    assert node_steps(PAPER | {"strikes": 91}) == pytest.approx(91 * node_steps(PAPER))
    apart = PAPER | {"strikes": 3, "strike_interval": 5e-3}
    assert node_steps(apart) == pytest.approx(11 * node_steps(PAPER))
    assert node_steps(PAPER | {"further": 1}) == pytest.approx(2 * node_steps(PAPER))
    timoshenko = node_steps(PAPER | {"beam_model": BEAM_MODELS.index("timoshenko")})
    assert timoshenko == pytest.approx(2.0 * wave)
    # columns are many runs at once
    columns = {name: np.array([value, value]) for name, value in PAPER.items()}
    columns["courant"] = np.array([0.5, 0.25])
    one, other = node_steps(columns)
    assert one == pytest.approx(node_steps(PAPER))
    assert other == pytest.approx(2 * one)


def test_a_light_sphere_asks_for_small_steps():
    """Return the stiffness of Hertz's spring at the depth that takes all energy, by hand."""
    light = case_table(
        replace(paper_impact(2.0), sphere=replace(paper_impact().sphere, mass=1e-12)),
        Discretisation(nodes=21),
        duration=1e-3,
    )
    stiffness = 4 / 3 * 0.035**0.5 / (0.91 / 208e9 + 0.91 / 210e9)
    depth = (1.25 * 1e-12 * 4.0 / stiffness) ** 0.4
    step = 2.0 / (1.5 * stiffness * depth**0.5 / 1e-12) ** 0.5
    assert work(light)[0] == pytest.approx(1e-3 / (0.9 * step) * (0.5 * 21 * 0.15 + 20), rel=1e-3)
    assert work(light)[0] > 1e4 * node_steps(light)[0]


@pytest.mark.parametrize("model", BEAM_MODELS)
@pytest.mark.parametrize(("nodes", "mass"), [(21, None), (101, None), (21, 1e-8)])
def test_steps_are_about_as_many_as_the_kernel_takes(model, nodes, mass):
    impact = replace(paper_impact(2.0), beam_model=model, contact="hertz")
    impact = replace(impact, sphere=replace(impact.sphere, mass=mass))
    case = case_table(impact, Discretisation(nodes=nodes), duration=1e-2)
    pair, section = make_pair(case[0]), fibre_section(case[0])
    _, steps = discretise(case[0], pair, section)
    number = BEAM_MODELS.index(model)
    rate = 0.5 * nodes * _RATES[number] + _BESIDES[number]
    assert 0.3 < work(case)[0] / rate / steps < 3.0


def _seconds(*cases):
    """Return the runs' processor times, each the least of several taken by turns."""
    batches, least = [np.repeat(case, 64) for case in cases], np.full(len(cases), np.inf)
    for _ in range(7):
        for i, batch in enumerate(batches):
            start = time.thread_time()
            solve(batch)
            least[i] = min(least[i], (time.thread_time() - start) / batch.size)
    return least


@pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="times compiled kernels")
@pytest.mark.parametrize(
    ("velocity", "nodes", "duration"),
    [(1.0, 51, 8e-3), (5.0, 201, 4e-3), (10.0, 101, 4e-3), (20.0, 51, 4e-3)],
)
def test_leaps_and_yielding_sections_cost_what_they_take(velocity, nodes, duration):
    """Against leapfrog, in one process; a scheme that makes every step is 10 to 45 times beside."""
    grid = Discretisation(nodes=nodes, scheme="modal")
    modal = case_table(paper_impact(velocity), grid, duration=duration)
    leapfrog = case_table(paper_impact(1.0), Discretisation(nodes=25), duration=4e-3)
    estimated = (work(modal) / work(leapfrog))[0]
    seconds, yardstick = _seconds(modal, leapfrog)
    assert 0.25 < estimated / (seconds / yardstick) < 4.0
