"""The mesh of a deck, read back, is the mesh."""

import decks
import numpy as np
import pytest

from impactlab.fem3d.solver.mesh import BEAM, SPHERE
from impactlab.fem3d.solver.springs import springs_of

pytestmark = pytest.mark.parametrize("flavour", ["abaqus", "calculix"])


def test_nodes_are_those_of_the_mesh_in_mm(written, mesh, flavour):
    table = decks.numbers(decks.named(written(flavour), "NODE"))
    np.testing.assert_array_equal(table[:, 0], np.arange(1, len(mesh.nodes) + 1))
    np.testing.assert_allclose(table[:, 1:], 1e3 * mesh.nodes, rtol=1e-12, atol=1e-15)
    # elements are those of the mesh each once
    groups = decks.elements(written(flavour))
    every = np.concatenate(list(groups.values()))
    every = every[np.argsort(every[:, 0])]
    np.testing.assert_array_equal(every[:, 0], np.arange(1, len(mesh.elements) + 1))
    np.testing.assert_array_equal(every[:, 1:], mesh.elements + 1)
    for name, rows in groups.items():
        body, kind = name.split("_")
        which = rows[:, 0] - 1
        assert np.all(mesh.body[which] == {"BEAM": BEAM, "SPHERE": SPHERE}[body])
        assert np.all(mesh.full[which] == (kind == "FINE"))
    # bodies are made of their groups
    deck = written(flavour)
    for body in ("BEAM", "SPHERE"):
        groups = {line[0] for line in decks.named(deck, "ELSET", ELSET=body).data}
        assert groups == {f"{body}_FINE", f"{body}_COARSE"}


def test_sets_are_where_they_should_be(written, impact, flavour):
    deck = written(flavour)
    place = decks.numbers(decks.named(deck, "NODE"))[:, 1:]

    def at(name):
        return place[decks.members(deck, name) - 1]

    def expect(name, where):
        np.testing.assert_array_equal(at(name), np.unique(place[where], axis=0))

    half, depth, radius = 50.0, 27.8, 35.0
    np.testing.assert_allclose(at("SYMMETRY_X")[:, 0], 0.0, atol=1e-9)
    np.testing.assert_allclose(at("SYMMETRY_Y")[:, 1], 0.0, atol=1e-9)
    assert len(at("SYMMETRY_X")) == np.sum(np.abs(place[:, 0]) < 1e-9)
    assert len(at("SYMMETRY_Y")) == np.sum(np.abs(place[:, 1]) < 1e-9)
    np.testing.assert_allclose(at("SUPPORT")[:, [0, 2]] - [half, -depth / 2], 0.0, atol=1e-9)
    np.testing.assert_allclose(at("MIDSPAN"), [[0.0, 0.0, -depth / 2]], atol=1e-9)
    np.testing.assert_allclose(at("SPHERE_CENTRE"), [[0.0, 0.0, radius]], atol=1e-9)
    np.testing.assert_allclose(at("SPHERE_POLE"), [[0.0, 0.0, 0.0]], atol=1e-9)
    np.testing.assert_allclose(at("BEAM_TOP"), [[0.0, 0.0, 0.0]], atol=1e-9)
    assert decks.members(deck, "SPHERE_POLE") != decks.members(deck, "BEAM_TOP")
    tracked = [decks.members(deck, name)[0] for name in ("MIDSPAN", "SPHERE_CENTRE")]
    assert set(tracked) <= set(decks.members(deck, "TRACKED"))
    inside = np.linalg.norm(at("SPHERE_NODES") - [0.0, 0.0, radius], axis=1)
    assert inside.max() == pytest.approx(radius)
    assert len(at("SPHERE_NODES")) == len(np.unique(decks.members(deck, "SPHERE_NODES")))


def test_surfaces_face_each_other_and_are_whole(written, flavour):
    deck = written(flavour)
    top, ball = decks.surface(deck, "BEAM_SURFACE"), decks.surface(deck, "SPHERE_SURFACE")
    assert np.all(np.abs(top[:, :, 2]) < 1e-9)
    area, normal = areas(top)
    assert area.sum() == pytest.approx(50.0 * 30.0)
    np.testing.assert_allclose(normal, [[0.0, 0.0, 1.0]] * len(top), atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(ball - [0.0, 0.0, 35.0], axis=2), 35.0, rtol=1e-9)
    area, normal = areas(ball)
    outwards = np.sum(normal * (ball.mean(axis=1) - [0.0, 0.0, 35.0]), axis=1)
    assert np.all(outwards > 0.0)
    assert area.sum() == pytest.approx(np.pi * 35.0**2 / 2.0, rel=0.15)
    assert ball[:, :, 2].max() == pytest.approx(35.0, abs=12.0)


def test_springs_of_a_deck_are_those_of_the_solver(written, sprung, sprung_mesh, flavour):
    deck = written(flavour, sprung, sprung_mesh)
    tables = [decks.numbers(card) for card in deck if card.keyword == "NODE"]
    places = {int(row[0]): row[1:] for table in tables for row in table}
    values = {card.parameters["ELSET"]: card.data for card in deck if card.keyword == "SPRING"}
    rows = []
    for name, ((direction,), (stiffness,)) in values.items():
        for _, *nodes in decks.named(deck, "ELEMENT", ELSET=name).data:
            if flavour == "abaqus":
                ground, node = (places[int(number)] for number in nodes)
                axis = int(np.argmax(np.abs(ground - node)))
                assert np.count_nonzero(ground - node) == 1
                assert abs(ground[axis]) >= 999.0  # so far away that it does not turn
                assert int(nodes[0]) in decks.members(deck, "GROUND")
            else:
                axis = int(direction) - 1
            rows.append((int(nodes[-1]) - 1, axis, 1e3 * float(stiffness)))
    springs = springs_of(sprung_mesh, sprung)
    expected = sorted(zip(*(values.tolist() for values in springs), strict=True))
    np.testing.assert_allclose(sorted(rows), expected, rtol=1e-9)
    numbers = [int(line[0]) for card in deck if card.keyword == "ELEMENT" for line in card.data]
    assert len(set(numbers)) == len(numbers) == len(sprung_mesh.elements) + len(rows)


def areas(faces):
    """Areas and unit normals; seen from outside, corners turn clockwise in the manuals."""
    vector = np.cross(faces[:, 3] - faces[:, 1], faces[:, 2] - faces[:, 0]) / 2.0
    area = np.linalg.norm(vector, axis=1)
    return area, vector / area[:, None]
