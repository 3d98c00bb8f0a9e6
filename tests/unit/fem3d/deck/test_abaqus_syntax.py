"""Abaqus decks keep to the documented syntax, and the checker sees when one does not."""

from dataclasses import replace

import abaqus_syntax
import pytest

from impactlab.fem3d.deck import write_deck


@pytest.fixture
def deck(tmp_path, impact, mesh):
    return write_deck(
        tmp_path / "deck.inp", impact, mesh, flavour="abaqus", duration=1e-4, interval=1e-6
    )


def test_the_deck_is_sound(deck):
    assert abaqus_syntax.complaints(deck) == []


def test_springs_are_sound(tmp_path, sprung, sprung_mesh):
    path = tmp_path / "deck.inp"
    write_deck(path, sprung, sprung_mesh, flavour="abaqus", duration=1e-4)
    assert abaqus_syntax.complaints(path) == []
    text = path.read_text()
    for good, bad, words in (
        ("SPRINGA", "SPRING1", "TYPE=SPRING1"),
        ("*SPRING, ELSET=SPRINGS_1\n\n", "*SPRING, ELSET=SPRINGS_1\n3\n", "is not blank"),
        ("*SPRING, ELSET=SPRINGS_1", "*SPRING, ELSET=SPRING", "SPRING is not defined"),
        ("GROUND, 1, 3", "BASE, 1, 3", "BASE is not defined"),
    ):
        assert good in text
        path.write_text(text.replace(good, bad, 1))
        assert any(words in complaint for complaint in abaqus_syntax.complaints(path))


@pytest.mark.parametrize("moduli", [(1e9, 0.0), (0.0, 2e9), (1e9, 2e9)])
def test_hardening_is_sound(tmp_path, impact, mesh, moduli):
    steel = replace(
        impact.beam.material,
        isotropic_hardening_modulus=moduli[0],
        kinematic_hardening_modulus=moduli[1],
    )
    this = replace(impact, beam=replace(impact.beam, material=steel))
    path = write_deck(tmp_path / "deck.inp", this, mesh, flavour="abaqus", duration=1e-4)
    assert abaqus_syntax.complaints(path) == []


def test_full_elements_are_about_the_contact_and_the_others_have_enhanced_hourglass(deck):
    deck = abaqus_syntax.cards(deck)
    kinds = {
        card.parameters["ELSET"]: card.parameters["TYPE"]
        for card in deck
        if card.keyword == "ELEMENT"
    }
    assert kinds == {
        "BEAM_FINE": "C3D8",
        "BEAM_COARSE": "C3D8R",
        "SPHERE_FINE": "C3D8",
        "SPHERE_COARSE": "C3D8R",
    }
    controls = {
        card.parameters["ELSET"]: card.parameters.get("CONTROLS")
        for card in deck
        if card.keyword == "SOLID SECTION"
    }
    assert {name for name, value in controls.items() if value} == {"BEAM_COARSE", "SPHERE_COARSE"}


@pytest.mark.parametrize(
    ("good", "bad", "words"),
    [
        ("*DENSITY", "*DENSITIES", "*DENSITIES: unknown"),
        ("TYPE=C3D8R", "TYPE=C3D8Q", "*ELEMENT: TYPE=C3D8Q"),
        (", MATERIAL=BEAM_STEEL", "", "*SOLID SECTION: MATERIAL is missing"),
        ("MATERIAL=BEAM_STEEL", "MATERIAL=IRON", "*SOLID SECTION: IRON is not defined"),
        ("SUPPORT, 3, 3", "SUPPORTS, 3, 3", "*BOUNDARY: SUPPORTS is not defined"),
        ("\nSPHERE_SURFACE, BEAM", "\nBALL, BEAM", "*CONTACT PAIR: BALL is not defined"),
        ("OUTPUT, CPSET=IMPACT", "OUTPUT, CPSET=X", "*CONTACT OUTPUT: X is not defined"),
        ("HOURGLASS=ENHANCED", "HOURGLASS=BETTER", "*SECTION CONTROLS: HOURGLASS=BETTER"),
        ("HISTORY, TIME INTERVAL", "HISTORY, EVERY", "*OUTPUT: no parameter EVERY"),
        ("S, PEEQ", "S, PEEQS", "*ELEMENT OUTPUT: PEEQS in FIELD"),
        ("*FRICTION\n0.\n", "*FRICTION\n", "*FRICTION: 0 data lines"),
        ("GRAV, 9810, 0, 0, -1", "GRAV, 9810", "*DLOAD: 3 entries per line"),
        ("*END STEP\n", "", "no *END STEP"),
        ("*MATERIAL, NAME=BEAM_STEEL\n", "", "*DENSITY: follows *SURFACE"),
        ("*BOUNDARY", "*STEP\n*BOUNDARY", "*BOUNDARY: inside the step"),
        ("*SURFACE, NAME", "** " + 300 * "x" + "\n*SURFACE, NAME", "303 characters"),
    ],
)
def test_the_checker_sees(deck, good, bad, words):
    text = deck.read_text()
    assert good in text
    deck.write_text(text.replace(good, bad, 1))
    assert any(words in complaint for complaint in abaqus_syntax.complaints(deck))
