"""A run as a dataset: names, units and shapes as the beam models have them."""

import numba
import numpy as np
import pytest

import impactlab as il
from impactlab.fem3d.solver import impact_mesh, solve_on
from impactlab.simulate import run_dataset
from impactlab.solver import outputs
from impactlab.variables import HISTORIES, RESPONSES, STATUS_FLAGS

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="thousands of elements")


@pytest.fixture(scope="module")
def mesh():
    return impact_mesh(il.paper_impact(5.0), element_size=2e-3)


@pytest.fixture(scope="module")
def answer(mesh):
    return solve_on(mesh, il.paper_impact(5.0), duration=25e-6, samples=101)


def test_what_the_beam_models_answer_too_has_the_same_names_and_units(answer):
    beam = run_dataset(
        il.paper_impact(5.0), il.Discretisation(nodes=21), duration=25e-6, samples=101
    )
    shared = {*HISTORIES, *RESPONSES} & set(answer.data_vars)
    assert set(HISTORIES) - shared == {"midspan_curvature"}
    missing = {entry.name for entry in outputs.RESPONSES if entry.beam_models_only}
    assert set(RESPONSES) - shared == missing
    for name in shared:
        assert answer[name].dims == beam[name].dims
        assert answer[name].attrs["units"] == beam[name].attrs["units"]
    assert float(answer["velocity"]) == 5.0
    assert "nodes" not in answer.coords
    assert "contact" not in answer.coords
    # everything has a unit and a name
    for name, variable in answer.variables.items():
        if name not in ("axis", "status"):
            assert {"units", "long_name"} <= set(variable.attrs), name
    # what is missing has a reason
    bits = int(answer["status"])
    reasons = {name for name, (bit, _) in STATUS_FLAGS.items() if bits & bit}
    assert reasons == {
        "first_contact_unfinished",
        "in_contact_at_end",
        "sphere_not_leaving",
        "deflection_still_growing",
        "indentation_still_growing",
    }
    missing = {name for name in RESPONSES if name in answer and np.isnan(answer[name])}
    assert missing == {
        name for name, entry in RESPONSES.items() if name in answer and entry.missing in reasons
    }


def test_fields_lie_on_the_mesh(answer, mesh):
    assert answer["element_nodes"].shape == (len(mesh.elements), 8)
    assert answer["displacement"].shape == mesh.nodes.shape
    strain = answer["equivalent_plastic_strain"]
    assert strain.dims == ("element",)
    deepest = int(np.argmax(strain.values))
    centre = mesh.nodes[mesh.elements[deepest]].mean(axis=0)
    assert answer["body"][deepest] == 0
    assert np.linalg.norm(centre) < mesh.patch
    assert float(answer["peak_plastic_strain"]) >= float(strain.max()) > 1e-3
    yielding = strain.values > 1e-3
    stress = answer["von_mises_stress"].values[yielding & (mesh.body == 0)]
    assert np.all(stress < 345e6 * (1 + 1e-9))
    assert stress.max() > 0.9 * 345e6
    assert float(answer["plastic_zone_length"]) >= 4e-3
    assert 0.0 < float(answer["node_offset"]) < 0.5
    # histories belong together
    np.testing.assert_allclose(
        answer["indentation"], answer["sphere_displacement"] - answer["midspan_deflection"]
    )
    assert answer["time"][-1] == answer["duration"]
    assert float(answer["sphere_displacement"][-1]) == pytest.approx(25e-6 * 5.0, rel=0.02)
    assert answer.sizes["time"] == 101
