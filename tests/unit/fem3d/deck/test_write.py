"""The text of a deck besides the mesh, and the cases that are refused."""

from dataclasses import replace

import decks
import numpy as np
import pytest

from impactlab.fem3d import kratos
from impactlab.fem3d.deck import FLAVOURS, write_deck
from impactlab.fem3d.solver import impact_mesh
from impactlab.fem3d.solver.dataset import solve_on
from impactlab.fem3d.solver.mesh import SPHERE

both = pytest.mark.parametrize("flavour", FLAVOURS)


@both
def test_same_arguments_give_the_same_text(tmp_path, impact, mesh, flavour):
    texts = [
        write_deck(tmp_path / name, impact, mesh, flavour=flavour, duration=1e-4).read_bytes()
        for name in ("one.inp", "two.inp")
    ]
    assert texts[0] == texts[1]


@both
def test_conditions_are_the_impact_in_n_mm_t_s(written, impact, flavour, mesh):
    deck = written(flavour)
    assert decks.named(deck, "INITIAL CONDITIONS").data == [["SPHERE_NODES", "3", "-990"]]
    assert decks.named(deck, "DLOAD").data == [["SPHERE", "GRAV", "9810", "0", "0", "-1"]]
    assert decks.named(deck, "BOUNDARY").data == [
        ["SYMMETRY_X", "1", "1"],
        ["SYMMETRY_Y", "2", "2"],
        ["SUPPORT", "3", "3"],
    ]
    weightless = written(flavour, replace(impact, gravity=0.0))
    assert not [card for card in weightless if card.keyword == "DLOAD"]
    # sphere weighs what the impact says
    deck = written(flavour)
    start = deck.index(decks.named(deck, "MATERIAL", NAME="SPHERE_STEEL"))
    density = float(deck[start + 1].data[0][0])
    quarter = np.array([tetrahedra(mesh.nodes[e]) for e in mesh.elements[mesh.body == SPHERE]])
    assert 4.0 * density * quarter.sum() * 1e9 == pytest.approx(1.5e-3, rel=1e-6)


@both
def test_a_half_holds_a_clamped_face_and_says_so(tmp_path, impact, flavour):
    beam = replace(impact.beam, support_left="clamped", support_right="free")
    other = replace(impact, beam=beam, strike_position=0.4)
    half = impact_mesh(other, element_size=3e-3, ratio=2.0, coarsest=0.02)
    path = write_deck(tmp_path / "deck.inp", other, half, flavour=flavour, duration=1e-4)
    deck = decks.cards(path)
    held = decks.named(deck, "BOUNDARY").data
    assert held == [["SYMMETRY_Y", "2", "2"], ["CLAMPED", "1", "3"]]
    sets = {card.parameters["NSET"]: card.data for card in deck if card.keyword == "NSET"}
    nodes = np.array([int(number) for row in sets["CLAMPED"] for number in row]) - 1
    face = np.flatnonzero(np.isclose(half.nodes[:, 0], -0.04))
    np.testing.assert_array_equal(np.sort(nodes), face)
    assert all(sets.values())  # none is empty
    head = " ".join(line[2:].strip() for line in path.read_text().splitlines() if "**" in line)
    assert "contact forces are a half of the whole" in head
    assert "left end is held all over its face, its right end free." in head


def tetrahedra(corners):
    """Volume of a hexahedron: the mean of its two cuts into five tetrahedra."""
    cuts = [
        [(0, 1, 3, 4), (1, 2, 3, 6), (1, 4, 5, 6), (3, 4, 6, 7), (1, 3, 4, 6)],
        [(0, 1, 2, 5), (0, 2, 3, 7), (0, 4, 5, 7), (2, 5, 6, 7), (0, 2, 5, 7)],
    ]
    parts = [np.linalg.det(corners[list(t[1:])] - corners[t[0]]) / 6 for cut in cuts for t in cut]
    return np.abs(parts).sum() / 2.0


def test_duration_and_interval_are_the_step(written):
    abaqus = written("abaqus", duration=2e-4, interval=5e-6)
    assert decks.named(abaqus, "DYNAMIC").data == [["", "0.0002"]]
    assert decks.named(abaqus, "OUTPUT", **{"TIME INTERVAL": "5e-06"}).parameters["HISTORY"] is None
    calculix = written("calculix", duration=2e-4, interval=5e-6)
    assert decks.named(calculix, "DYNAMIC").data == [["5e-06", "0.0002"]]
    # interval is a 60th of the contact or the duration
    modulus = 208e9 * 210e9 / (418e9 * 0.91)
    deepest = (15.0 * 1.5 * 0.99**2 / (16.0 * modulus * 0.035**0.5)) ** 0.4
    for duration, expected in ((1e-3, 2.9433 * deepest / 0.99 / 60.0), (1e-6, 1e-6)):
        (step,) = decks.named(written("calculix", duration=duration), "DYNAMIC").data
        assert float(step[0]) == pytest.approx(expected, rel=1e-4)
    # flavours are the two that the docs name
    assert set(FLAVOURS) == {"abaqus", "calculix"}


@both
def test_header_says_what_it_is(tmp_path, impact, mesh, flavour):
    text = write_deck(tmp_path / "d.inp", impact, mesh, flavour=flavour, duration=1e-4).read_text()
    head = " ".join(line[2:].strip() for line in text.splitlines() if line.startswith("**"))
    program = {"abaqus": "Abaqus/Explicit", "calculix": "CalculiX"}[flavour]
    for words in (
        f"for {program}",
        "N, mm, t, s",
        f"{len(mesh.nodes)} nodes, {len(mesh.elements)} elements",
        "impact velocity: 0.99 m s-1",
        "mass of the sphere: 1.5 kg",
        "span of the beam: 0.1 m",
        "a quarter of the whole",
        {"abaqus": "Never run", "calculix": "CalculiX 2.20 crashes"}[flavour],
    ):
        assert words in head
    assert "contact law" not in head


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"flavour": "ansys"}, "deck.flavour = 'ansys': must be one of abaqus, calculix"),
        ({"duration": 0.0}, "deck.duration = 0.0: must be above zero"),
        ({"duration": "long"}, "deck.duration = 'long': must be a finite number"),
        ({"impact": None}, "deck.impact = None: must be an Impact"),
        ({"interval": 1.0}, "deck.interval = 1.0 s: must not be above the duration"),
        ({"mesh": None}, "deck.mesh = None: must be a Mesh"),
        ({"path": "no/such/folder/deck.inp"}, "cannot write no/such/folder/deck.inp: No such"),
    ],
)
def test_mistakes_are_named(tmp_path, impact, mesh, options, words):
    arguments = {
        "path": tmp_path / "deck.inp",
        "impact": impact,
        "mesh": mesh,
        "flavour": "abaqus",
        "duration": 1e-4,
        **options,
    }
    with pytest.raises(ValueError, match=words):
        write_deck(**arguments)


@pytest.mark.parametrize(
    ("length", "wrong"), [("span", 0.2), ("width", 0.02), ("depth", 0.02), ("radius", 0.02)]
)
def test_the_mesh_of_another_impact_is_refused(tmp_path, impact, mesh, length, wrong):
    body = "sphere" if length == "radius" else "beam"
    other = replace(impact, **{body: replace(getattr(impact, body), **{length: wrong})})
    for take in (
        lambda: write_deck(tmp_path / "deck.inp", other, mesh, flavour="abaqus", duration=1e-4),
        lambda: solve_on(mesh, other, duration=1e-4),
        lambda: kratos.solve_on(mesh, other, duration=1e-4),
    ):
        with pytest.raises(ValueError, match=rf"mesh: the {body}'s {length} is .* {wrong} m in"):
            take()


@pytest.mark.parametrize(
    ("beam", "place", "words"),
    [
        ({"support_left": "clamped"}, 0.5, "ends are pinned and pinned in the mesh and clamped"),
        ({}, 0.4, r"strike from the left end is 0\.05 m in the mesh and 0\.04 m in"),
        ({"support_right": "free"}, 1.0, "strike_position = 1.0: the 3-D model needs beam on both"),
        ({"damping_ratio": 0.1}, 0.5, r"damping_ratio = 0\.1: is of modes, which the 3-D model"),
    ],
)
def test_another_beam_or_place_is_refused(impact, mesh, beam, place, words):
    other = replace(impact, beam=replace(impact.beam, **beam), strike_position=place)
    with pytest.raises(ValueError, match=words):
        solve_on(mesh, other, duration=1e-4)


def test_kratos_gets_quarters_of_pinned_beams_alone(impact):
    other = replace(impact, strike_position=0.4)
    half = impact_mesh(other, element_size=3e-3, ratio=2.0, coarsest=0.02)
    with pytest.raises(ValueError, match="Kratos gets quarters of a pinned beam"):
        kratos.solve_on(half, other, duration=1e-4)
    damped = replace(impact, beam=replace(impact.beam, mass_damping=10.0))
    quarter = impact_mesh(damped, element_size=3e-3, ratio=2.0, coarsest=0.02)
    with pytest.raises(ValueError, match=r"strike_position: 0\.5, mass_damping: 0, "):
        kratos.solve_on(quarter, damped, duration=1e-4)
