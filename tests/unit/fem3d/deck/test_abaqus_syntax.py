"""Abaqus decks keep to the documented syntax."""

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
