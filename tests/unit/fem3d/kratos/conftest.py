"""The paper's case at 1 mm about the contact, on a mesh that is coarse elsewhere."""

import pytest

from impactlab.fem3d.solver import impact_mesh
from impactlab.model.impact import paper_impact


@pytest.fixture(scope="package")
def impact():
    return paper_impact(velocity=0.99)


@pytest.fixture(scope="package")
def mesh(impact):
    return impact_mesh(impact, element_size=1e-3, ratio=2.0, coarsest=20e-3)
