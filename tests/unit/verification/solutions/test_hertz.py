"""Constants of Hertz's impact and of one mass on a spring; the checks solve the rest again."""

import numpy as np
import pytest
from scipy.integrate import quad

from impactlab.model.impact import paper_impact
from impactlab.verification.cases import timoshenko_impact
from impactlab.verification.solutions import hertz
from impactlab.verification.solutions.beam_modes import odd_modes

PAPER = paper_impact(contact="hertz")


def test_effective_modulus_of_like_bodies_is_half_the_plane_strain_one():
    steel = timoshenko_impact().beam.material
    expected = steel.youngs_modulus / (2 * (1 - 0.3**2))
    assert hertz.effective_modulus(timoshenko_impact()) == pytest.approx(expected, rel=1e-12)
    assert hertz.effective_modulus(paper_impact()) == pytest.approx(
        208e9 * 210e9 / (418e9 * 0.91), rel=1e-12
    )
    assert pytest.approx(2.9433, abs=5e-5) == hertz.CONTACT_TIME_FACTOR


def test_mass_and_stiffness_by_quadrature_of_the_static_shape():
    beam, L = PAPER.beam, PAPER.beam.span

    def shape(x):
        return (3 * x * L**2 - 4 * x**3) / L**3

    energy, _ = quad(lambda x: 2 * shape(x) ** 2, 0, L / 2)
    bending, _ = quad(lambda x: 2 * (24 * x / L**3) ** 2, 0, L / 2)
    mass, stiffness = hertz.spring_mass(beam)
    assert mass == pytest.approx(beam.mass_per_length * energy, rel=1e-12)
    assert stiffness == pytest.approx(beam.bending_stiffness * bending, rel=1e-12)
    # Above the first of the modes, and close to it.
    mass, stiffness = hertz.spring_mass(PAPER.beam)
    ratio = np.sqrt(stiffness / mass) / odd_modes(PAPER.beam, 1).frequencies[0]
    assert ratio == pytest.approx(1.0072, abs=1e-4)


@pytest.mark.parametrize(
    ("call", "word"),
    [
        (lambda: hertz.solve(paper_impact(contact="stronge"), 1e-4), "contact"),
        (lambda: hertz.solve_spring_mass(PAPER, 1e-5).at("contact_force", [2e-5]), "time:"),
    ],
)
def test_wrong_arguments_are_named(call, word):
    with pytest.raises(ValueError, match=word):
        call()
