"""What a study must and must not say where some of its runs are of the 3-D model."""

from __future__ import annotations

import pytest

from impactlab.study.sampling import design

SOLID = {
    "sampling.parameters": {"beam_model": ["timoshenko", "solid"]},
    "discretisation": {"element_size": "2 mm"},
    "responses": ["peak_force", "maximum_deflection"],
}


def test_a_study_of_both_is_of_the_witness(read, grid):
    study = read(grid(SOLID))
    assert study.discretisation.element_size == 2e-3
    assert design(study).attrs["solver"] == "witness"
    assert design(study)["element_size"].item() == 2e-3
    plain = design(read(grid({"sampling.parameters": {"beam_model": ["timoshenko"]}})))
    assert plain.attrs["solver"] == "impact"
    assert "element_size" not in plain.coords


@pytest.mark.parametrize(
    ("name", "values", "read_as"),
    [("element_size", ["2 mm", 1e-3], (2e-3, 1e-3)), ("elements_per_radius", [2, 4.5], (2.0, 4.5))],
)
def test_sizes_can_be_varied(read, grid, name, values, read_as):
    several = {"beam_model": ["solid"], name: values}
    study = read(grid(SOLID | {"sampling.parameters": several, "discretisation": {}}))
    assert study.sampling.parameters[name] == read_as


@pytest.mark.parametrize(
    ("changes", "key", "said"),
    [
        ({"discretisation": {"nodes": 51}}, "discretisation.element_size", "is required"),
        ({"responses": "all"}, "responses", "contact_dissipation is not known"),
        ({"store": {"profiles": True}}, "store.profiles", "must be false"),
        ({"discretisation": "auto"}, "discretisation.auto", "is not for beam_model: solid"),
        (
            {"sampling.parameters": {"velocity": [1.0]}},
            "discretisation.element_size",
            "has no effect without beam_model: solid",
        ),
        (
            {"sampling.parameters": {"element_size": [1e-3]}, "discretisation": {}},
            "sampling.parameters.element_size",
            "has no effect without beam_model: solid",
        ),
        ({"discretisation": {"element_size": 0}}, "discretisation.element_size", "above zero"),
        (
            {"sampling.parameters": {"beam_model": ["solid"], "elements_per_radius": [2, 4]}},
            "sampling.parameters.elements_per_radius",
            "discretisation.element_size says it already",
        ),
    ],
)
def test_what_contradicts_it_is_told_at_its_key(problems, grid, changes, key, said):
    found = dict(problems(grid(SOLID | changes)))
    assert said in found[key]


def test_a_sample_has_no_solid(problems, sample):
    changes = {
        "impact.beam_model": "solid",
        "discretisation": {"element_size": "1 mm"},
        "responses": ["peak_force"],
    }
    ((key, said),) = problems(sample(changes))
    assert key == "sampling.method"
    assert "method: grid" in said
