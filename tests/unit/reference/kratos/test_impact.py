"""Two engines, one mesh: the solid model and Kratos answer alike."""

from __future__ import annotations

import pytest
import xarray as xr

from impactlab.model.impact import Impact
from impactlab.reference import kratos, solid
from impactlab.reference.solid import Mesh

pytestmark = pytest.mark.kratos

DURATION = 2.8e-4


@pytest.fixture(scope="module")
def theirs(mesh: Mesh, impact: Impact) -> xr.Dataset:
    return kratos.solve_on(mesh, impact, duration=DURATION)


@pytest.fixture(scope="module")
def ours(mesh: Mesh, impact: Impact) -> xr.Dataset:
    return solid.solve_on(mesh, impact, duration=1.02 * DURATION)


def test_a_contact_that_leaves_the_patch_is_told(impact: Impact) -> None:
    small = solid.quarter_mesh(impact, element_size=0.4e-3, patch=0.8e-3, ratio=2.0, coarsest=20e-3)
    with pytest.raises(solid.PatchTooSmallError, match=r"above 0\.0008 m"):
        kratos.solve_on(small, impact, duration=8e-5)
