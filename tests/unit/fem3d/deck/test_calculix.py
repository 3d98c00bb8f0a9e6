"""CalculiX reads the decks, and finds Hertz's impact with one."""

import re
from dataclasses import replace

import calculix
import numpy as np
import pytest

from impactlab.fem3d.deck import write_deck
from impactlab.fem3d.solver import impact_mesh, solve_on
from impactlab.fem3d.solver.springs import springs_of
from impactlab.model.impact import paper_impact


def counted(screen, what):
    """A number of CalculiX's summary of what it has read."""
    return int(re.findall(rf"^ +{what}: +(\d+)$", screen, re.MULTILINE)[0])


def small_deck(tmp_path, impact, mesh, plastic):
    """A deck of one step."""
    return write_deck(
        tmp_path / "deck.inp",
        impact,
        mesh,
        flavour="calculix",
        duration=1e-6,
        interval=1e-6,
        plastic=plastic,
    )


def check_read(screen, mesh, sets=18):
    """All that is in the deck has been understood."""
    assert "*ERROR" not in screen
    assert "*WARNING" not in screen
    assert "STEP            1" in screen
    assert counted(screen, "elements") == len(mesh.elements)
    inner = 3 * len(mesh.elements)  # that C3D8I adds for its incompatible modes
    assert counted(screen, "nodes") == len(mesh.nodes) + inner
    assert counted(screen, "sets") == sets
    assert counted(screen, "materials") == 3  # and the surface interaction


@calculix.needed
def test_a_deck_with_springs_is_read_and_steps(tmp_path, sprung, sprung_mesh):
    found = calculix.run(small_deck(tmp_path, sprung, sprung_mesh, plastic=False))
    assert found.code == 0
    assert "Job finished" in found.screen
    assert "*ERROR" not in found.screen
    assert "*WARNING" not in found.screen
    springs = springs_of(sprung_mesh, sprung).nodes.size
    assert counted(found.screen, "elements") == len(sprung_mesh.elements) + springs


@calculix.needed
@pytest.mark.parametrize("place", [0.5, 0.4])
def test_elastic_deck_is_read_and_steps(tmp_path, impact, mesh, place):
    sets = 18
    if place != 0.5:
        beam = replace(impact.beam, support_left="clamped", support_right="free")
        impact = replace(impact, beam=beam, strike_position=place)
        mesh = impact_mesh(impact, element_size=3e-3, ratio=2.0, coarsest=0.02)
        sets = 17  # one less that is held
    found = calculix.run(small_deck(tmp_path, impact, mesh, plastic=False))
    check_read(found.screen, mesh, sets)
    assert found.code == 0
    assert "Job finished" in found.screen
    times, places = found.table("displacements")
    np.testing.assert_allclose(times, [1e-6])
    np.testing.assert_allclose(places[0, 1:3, 3], -0.99e-3, rtol=1e-3)  # the sphere's, in mm


@calculix.needed
def test_plastic_deck_is_read(tmp_path, impact, mesh):
    """Its contact left out, which is that of the elastic deck, and with which it crashes."""
    path = small_deck(tmp_path, impact, mesh, plastic=True)
    text = path.read_text()
    for card in (r"\*CONTACT PAIR", r"\*CONTACT PRINT"):
        text, count = re.subn(rf"{card}.*\n.*\n", "", text)
        assert count == 1
    path.write_text(text)
    found = calculix.run(path)
    check_read(found.screen, mesh)
    assert found.code == 0
    assert "Job finished" in found.screen
    assert counted(found.screen, "plastic data points per material") == 1


ENDS = {
    **{"support_left": "elastic", "support_right": "clamped", "foundation_stiffness": 1e9},
    **{"stiffness_left": 2e7, "rotational_stiffness_left": 2e4},
}


@calculix.needed
@pytest.mark.long
def test_a_half_answers_as_our_own_3d_model(tmp_path):
    """Elastic, of a beam so short that its ends matter before the contact is over."""
    paper = paper_impact()
    beam, sphere = (
        replace(body, material=replace(body.material, yield_stress=50e9))
        for body in (replace(paper.beam, span=0.2, **ENDS), paper.sphere)
    )
    this = replace(paper, beam=beam, sphere=sphere, strike_position=0.4, gravity=0.0)
    mesh = impact_mesh(this, element_size=1.5e-3, ratio=2.0, coarsest=14e-3, patch=3e-3)
    path = tmp_path / "half.inp"
    steps = {"duration": 3e-4, "interval": 1e-5}
    write_deck(path, this, mesh, flavour="calculix", plastic=False, **steps)
    found = calculix.run(path)
    assert found.code == 0
    run = solve_on(mesh, this, duration=3.1e-4)
    times, forces = found.contact()
    force = np.interp(times, run["time"], run["contact_force"])
    assert 2.0 * forces[:, 2].max() == pytest.approx(force.max(), rel=0.02)
    impulse = 2.0 * np.trapezoid(forces[:, 2], times)
    assert impulse == pytest.approx(np.trapezoid(force, times), rel=0.02)
    times, places = found.table("displacements")
    ours = 1e3 * np.interp(times, run["time"], run["midspan_deflection"])
    np.testing.assert_allclose(-places[:, 0, 3], ours, rtol=0.0, atol=0.03 * ours.max())
