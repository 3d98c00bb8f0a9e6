import numpy as np
import pytest

from impactlab.model.impact import paper_impact
from impactlab.paper.statements import misprints

BEAM = paper_impact().beam
NODES = 41


def operator():
    """-w_tt over w: the matrix of the march, supports left out."""
    dx = BEAM.span / (NODES - 1)
    inner = NODES - 2
    second = np.diag(np.full(inner, -2.0)) + np.eye(inner, k=1) + np.eye(inner, k=-1)
    return BEAM.bending_stiffness / BEAM.mass_per_length * (second @ second) / dx**4


def test_highest_frequency_bounds_the_spectrum_closely():
    largest = np.sqrt(np.linalg.eigvalsh(operator()).max())
    bound = misprints.highest_frequency(BEAM, NODES)
    assert largest < bound < largest / (1.0 - 2.0 * (np.pi / (2.0 * NODES)) ** 2)


def test_the_bending_step_is_where_growth_begins():
    dt = misprints.bending_step(BEAM, NODES)
    frequency = misprints.highest_frequency(BEAM, NODES)
    assert misprints.growth(frequency, dt) == 1.0
    assert misprints.growth(frequency, 1.001 * dt) > 1.0
    assert misprints.march(BEAM, NODES, 0.99 * dt, 2000).max() < 1.0
    assert misprints.march(BEAM, NODES, 1.1 * dt, 2000)[-1] == np.inf


def test_a_march_grows_as_the_closed_form_says():
    dt = 3.0 * misprints.bending_step(BEAM, NODES)
    frequency = np.sqrt(np.linalg.eigvalsh(operator()).max())
    history = misprints.march(BEAM, NODES, dt, 60)
    growth = misprints.growth(float(frequency), dt)
    assert history[-1] / history[-2] == pytest.approx(growth, rel=0.02)
    assert growth > 10.0


def test_a_beam_with_the_moments_sign_turned_round_grows():
    dt = 0.99 * misprints.bending_step(BEAM, NODES)
    frequency = np.sqrt(np.linalg.eigvalsh(operator()).max())
    history = misprints.march(BEAM, NODES, dt, 60, sign=-1.0)
    growth = misprints.growth(float(frequency), dt, sign=-1.0)
    assert history[-1] / history[-2] == pytest.approx(growth, rel=0.02)
    assert growth > 5.0


def test_the_papers_rule_is_stable_on_coarse_grids_alone():
    """Bending is softer than a bar there: dx >= 2 H/sqrt(12), 49 nodes and fewer."""
    for nodes, stable in ((49, True), (51, False)):
        dt = misprints.bar_wave_step(BEAM, nodes)
        assert (dt <= misprints.bending_step(BEAM, nodes)) is stable
