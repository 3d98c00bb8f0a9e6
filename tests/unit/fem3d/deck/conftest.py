"""One coarse case, and its decks."""

from dataclasses import replace

import decks
import pytest

from impactlab.fem3d.deck import write_deck
from impactlab.fem3d.solver import impact_mesh
from impactlab.model.bodies import Beam
from impactlab.model.impact import paper_impact


@pytest.fixture(scope="session")
def impact():
    """The paper's sphere, a little heavier than its volume, on a short beam."""
    paper = paper_impact()
    beam = Beam(span=0.1, width=0.06, depth=0.0278, material=paper.beam.material)
    return replace(paper, beam=beam, sphere=replace(paper.sphere, mass=1.5))


@pytest.fixture(scope="session")
def mesh(impact):
    return impact_mesh(impact, element_size=3e-3, ratio=2.0, coarsest=0.02)


@pytest.fixture(scope="session")
def sprung(impact):
    """The same on springs at one end, clamped at the other, on a foundation."""
    springs = {"stiffness_left": 1e7, "rotational_stiffness_left": 1e4, "foundation_stiffness": 1e9}
    ends = {"support_left": "elastic", "support_right": "clamped"}
    return replace(impact, beam=replace(impact.beam, **ends, **springs), strike_position=0.4)


@pytest.fixture(scope="session")
def sprung_mesh(sprung):
    return impact_mesh(sprung, element_size=3e-3, ratio=2.0, coarsest=0.02)


@pytest.fixture
def written(tmp_path, impact, mesh):
    """Writes a deck, and returns its cards."""

    def write(flavour, this=impact, mesh=mesh, **options):
        options.setdefault("duration", 1e-4)
        path = write_deck(tmp_path / "deck.inp", this, mesh, flavour=flavour, **options)
        return decks.cards(path)

    return write
