"""The responses that must converge smoothly do so with second order in dx."""

import numpy as np
import pytest

import impactlab as il


@pytest.mark.parametrize("velocity", [0.99, 5.0])
def test_peak_force_and_contact_duration_converge_with_second_order(velocity):
    runs = [
        il.simulate(il.paper_impact(velocity), il.Discretisation(nodes=nodes), duration=0.4e-3)
        for nodes in (101, 201, 401, 801)
    ]
    for name in ("peak_force", "contact_duration", "maximum_indentation"):
        values = np.array([run[name].item() for run in runs])
        steps = np.diff(values)
        assert np.log2(np.abs(steps[:-1] / steps[1:])) == pytest.approx(2, abs=0.35), name
