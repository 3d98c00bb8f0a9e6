"""A small design and its requested output; reports without figures."""

import pytest
import xarray as xr

import impactlab as il
from impactlab.model.parameters import flatten
from impactlab.report.study import write_report


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


@pytest.fixture
def page_of():
    """Return a function that solves and reports a study without figures, which take seconds."""

    def page(study, **options):
        runs, file = study.run(workers=1, **options), study.folder / "report.html"
        (study.folder / "captions.json").write_text("{}")
        write_report(runs, study.analyse(), study.folder, file)
        return file.read_text("utf-8").replace("\xa0", " ")

    return page
