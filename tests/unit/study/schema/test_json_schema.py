"""The JSON Schema marks the mistakes that an editor can."""

from copy import deepcopy
from functools import reduce
from pathlib import Path

import pytest
from ruamel.yaml import YAML

from impactlab.study.schema.readers import study_of_content
from impactlab.validation.errors import StudyError

SOBOL = Path(__file__).parents[4] / "studies" / "sobol.yaml"
VARIED = ("sampling", "parameters", "beam_yield_stress")


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("impct",), {}),
        (("title",), 1),
        (("impact", "contact"), "herz"),
        (("impact", "beam"), {"depht": 1}),
        (("discretisation", "nodes"), 20.5),
        (("duration",), None),
        (("responses",), ["peak_forces"]),
        (("limits",), {"peak_force": []}),
        (("sampling", "method"), "sobl"),
        (("sampling", "base_sample"), 8),
        (("sampling", "parameters", "yield"), {"distribution": "fixed", "value": 1}),
        (VARIED, {"distribution": "uniform", "low": 1, "hihg": 2}),
        (VARIED, {"distribution": "choice", "values": ["soft", "hard"]}),
        (VARIED, [1, 2]),
    ],
)
def test_a_mistake_is_marked_that_the_reader_refuses(validator, path, value):
    study = YAML(typ="safe").load(SOBOL)
    *above, key = path
    reduce(lambda node, step: node[step], above, study)[key] = value
    assert list(validator.iter_errors(study))
    with pytest.raises(StudyError):
        study_of_content("sobol", deepcopy(study), Path("sobol.yaml"))
