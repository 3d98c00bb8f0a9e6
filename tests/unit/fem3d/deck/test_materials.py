"""Plasticity: what the cards say, and what CalculiX makes of them in a bar pulled and pushed."""

from dataclasses import replace

import calculix
import decks
import numpy as np
import pytest

from impactlab.verification.solutions.bending import path_stresses

YIELD, ISOTROPIC, KINEMATIC = 345.0, 4e3, 9e3  # MPa
KINDS = [(0.0, 0.0), (ISOTROPIC, 0.0), (0.0, KINEMATIC), (ISOTROPIC, KINEMATIC)]


def hardening(impact, isotropic, kinematic):
    """The impact with a beam that hardens by these moduli in MPa."""
    steel = replace(
        impact.beam.material,
        isotropic_hardening_modulus=isotropic * 1e6,
        kinematic_hardening_modulus=kinematic * 1e6,
    )
    return replace(impact, beam=replace(impact.beam, material=steel))


def material(deck, name):
    """The cards of one material."""
    start = deck.index(decks.named(deck, "MATERIAL", NAME=name))
    kinds = ("DENSITY", "ELASTIC", "PLASTIC", "CYCLIC HARDENING")
    end = next(i for i in range(start + 1, len(deck)) if deck[i].keyword not in kinds)
    return deck[start:end]


@pytest.mark.parametrize("flavour", ["abaqus", "calculix"])
def test_elasticity_in_mpa_and_no_plasticity_unless_wanted(written, flavour):
    deck = written(flavour, plastic=False)
    cards = material(deck, "BEAM_STEEL")
    assert [card.keyword for card in cards] == ["MATERIAL", "DENSITY", "ELASTIC"]
    assert [card.data for card in cards[1:]] == [[["7.8e-09"]], [["210000", "0.3"]]]
    assert decks.named(material(deck, "SPHERE_STEEL"), "ELASTIC").data == [["208000", "0.3"]]


@pytest.mark.parametrize(
    ("moduli", "parameters", "data"),
    [
        (KINDS[0], {}, [[345, 0]]),
        (KINDS[1], {}, [[345, 0], [40345, 10]]),
        (KINDS[2], {"HARDENING": "KINEMATIC"}, [[345, 0], [90345, 10]]),
        (
            KINDS[3],
            {"HARDENING": "COMBINED", "DATA TYPE": "PARAMETERS", "NUMBER BACKSTRESSES": "1"},
            [[345, 9000, 0]],
        ),
    ],
)
def test_abaqus_cards(written, impact, moduli, parameters, data):
    cards = material(written("abaqus", hardening(impact, *moduli)), "BEAM_STEEL")
    plastic = decks.named(cards, "PLASTIC")
    assert plastic.parameters == parameters
    assert decks.numbers(plastic).tolist() == data
    cyclic = [card for card in cards if card.keyword == "CYCLIC HARDENING"]
    both = all(moduli)
    assert [decks.numbers(card).tolist() for card in cyclic] == both * [[[345, 0], [40345, 10]]]


def test_damping_is_a_card_of_the_beam_and_refused_where_it_would_be_of_more(
    written, impact, mesh, sprung, sprung_mesh
):
    def damped(impact, **values):
        return replace(impact, beam=replace(impact.beam, **values))

    deck = written("abaqus", damped(impact, mass_damping=12.5, stiffness_damping=3e-7))
    damping = decks.named(deck, "DAMPING")
    assert damping.parameters == {"ALPHA": "12.5", "BETA": "3e-07"}
    assert deck[deck.index(damping) - 3] == decks.named(deck, "MATERIAL", NAME="BEAM_STEEL")
    with pytest.raises(ValueError, match=r"CalculiX 2\.20 damps the sphere, too: set it to 0, or"):
        written("calculix", damped(impact, mass_damping=12.5))
    with pytest.raises(ValueError, match="stiffness_damping = 1e-07: springs of decks are"):
        written("abaqus", damped(sprung, stiffness_damping=1e-7, mass_damping=1.0), sprung_mesh)
    deck = written("abaqus", damped(sprung, mass_damping=1.0), sprung_mesh)
    assert decks.named(deck, "DAMPING").parameters == {"ALPHA": "1", "BETA": "0"}


BAR = """*NODE
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
*NSET, NSET=END
5, 6, 7, 8
*ELEMENT, TYPE=C3D8, ELSET=BAR
1, 1, 2, 3, 4, 5, 6, 7, 8
*SOLID SECTION, ELSET=BAR, MATERIAL=BEAM_STEEL
*BOUNDARY
1, 1, 3
2, 2, 3
3, 3, 3
4, 1, 1
4, 3, 3
5, 1, 2
6, 2, 2
8, 1, 1
"""
STEP = """*STEP, INC=1000
*STATIC, DIRECT
0.05, 1.
*BOUNDARY
END, 3, 3, {}
*EL PRINT, ELSET=BAR
S
*END STEP
"""


def pulled(folder, cards, strains):
    """Stress (MPa) of CalculiX's bar of this material at the end of each step."""
    deck = folder / "bar.inp"
    steps = "".join(STEP.format(strain) for strain in strains)
    deck.write_text(BAR + "\n".join(text(cards)) + "\n" + steps)
    found = calculix.run(deck)
    assert found.code == 0
    times, rows = found.table("stresses")
    ends = [np.flatnonzero(np.isclose(times, step + 1))[-1] for step in range(len(strains))]
    return rows[ends, :, 4].mean(axis=1)


def text(cards):
    """Cards as they stood in the deck."""
    for card in cards:
        words = [f"{k}={v}" for k, v in card.parameters.items()]
        yield ", ".join([f"*{card.keyword}", *words])
        yield from (", ".join(line) for line in card.data)


@calculix.needed
@pytest.mark.parametrize("modulus", [0.0, ISOTROPIC])
def test_calculix_hardens_as_the_fibres_do(tmp_path, written, impact, modulus):
    this = hardening(impact, modulus, 0.0)
    cards, strains = material(written("calculix", this), "BEAM_STEEL"), [0.006, -0.004, 0.005]
    expected = 1e-6 * path_stresses(this.beam.material, np.array([0.0, *strains]))[1:]
    np.testing.assert_allclose(pulled(tmp_path, cards, strains), expected, rtol=0.01)


@calculix.needed
def test_calculix_softens_with_kinematic_hardening(tmp_path, written, impact):
    """So the decks refuse it."""
    cards = material(written("abaqus", hardening(impact, 0.0, KINEMATIC)), "BEAM_STEEL")
    assert pulled(tmp_path, cards, [0.003, 0.006])[1] < YIELD
    # kinematic hardening is refused for calculix unless elastic
    this = hardening(impact, 0.0, KINEMATIC)
    with pytest.raises(ValueError, match=r"kinematic_hardening_modulus = 9000000000\.0 Pa"):
        written("calculix", this)
    assert written("calculix", this, plastic=False)


@pytest.mark.parametrize("field", ["rate_coefficient", "rate_sensitivity"])
def test_a_strain_rate_is_refused(written, impact, field):
    steel = replace(impact.beam.material, **{field: 0.5})
    with pytest.raises(ValueError, match=rf"Material\.{field} = 0\.5: .* set it to 0"):
        written("abaqus", replace(impact, beam=replace(impact.beam, material=steel)))
