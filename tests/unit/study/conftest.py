"""A small design and its requested output."""

import pytest
import xarray as xr

import impactlab as il
from impactlab.model.parameters import flatten


@pytest.fixture
def small_design():
    """A grid of velocities and two meshes, solved in milliseconds."""

    def made(*velocities, **attrs):
        fixed = flatten(il.paper_impact(), il.Discretisation(points=3))
        del fixed["velocity"], fixed["nodes"]
        asked = {
            "study": "small",
            "varied": ["velocity", "nodes"],
            "responses": ["peak_force"],
            "histories": 0,
            "profiles": 0,
            "history_samples": 21,
        }
        coords = {"velocity": list(velocities), "nodes": [11, 21], "duration": 4e-4} | fixed
        return xr.Dataset(coords=coords, attrs=asked | attrs)

    return made
