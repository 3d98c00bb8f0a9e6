"""A test function behind the door of the solver."""

import numpy as np
import xarray as xr

from impactlab.study.engine import Engine
from impactlab.study.execute import execute
from impactlab.verification.functions import FUNCTIONS


def design(**coords):
    attrs = {"solver": "function", "function": "ishigami", "varied": [*coords], "histories": 0}
    given = {"x3": 0.5} | {name: ("run", values) for name, values in coords.items()}
    return xr.Dataset(
        coords=given, attrs=attrs | {"profiles": 0, "history_samples": 10, "study": "f"}
    )


def test_values_are_the_functions_under_the_designs_labels(tmp_path):
    x1, x2 = np.linspace(-3, 3, 40), np.cos(np.arange(40))
    runs = execute(design(x2=x2, x1=x1), tmp_path, Engine(workers=2))
    points = np.stack([x1, x2, np.full(40, 0.5)], axis=1)
    np.testing.assert_array_equal(runs["value"], FUNCTIONS["ishigami"].value(points))
    assert runs["value"].dims == ("run",)
    assert (runs["status"] == 0).all()
    assert "Ishigami" in runs["value"].attrs["long_name"]
