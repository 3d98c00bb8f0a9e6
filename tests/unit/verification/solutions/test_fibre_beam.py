"""Fibre elements against the elastic modal series, against themselves, and against OpenSees."""

import numpy as np
import pytest

from impactlab.model.impact import paper_impact
from impactlab.verification import plasticity
from impactlab.verification.cases import elastic
from impactlab.verification.solutions import fibre_beam, modal


def apart(one, other):
    """Largest difference over the largest value."""
    return np.abs(one - other).max() / np.abs(other).max()


@pytest.mark.parametrize("velocity", [0.99, 5.0])
@pytest.mark.parametrize("name", ["contact_force", "midspan_deflection"])
def test_elastic_impact_is_that_of_the_modal_series(velocity, name):
    """Average acceleration is of second order in the time step."""
    impact, duration, errors = elastic(paper_impact(velocity)), 0.4e-3, []
    series = modal.solve(impact, duration)
    for steps in (200, 400):
        run = fibre_beam.solve(impact, duration, elements=32, steps=steps)
        errors.append(apart(getattr(run, name), series.at(name, run.time)))
        assert run.plastic_dissipation == 0.0
    assert errors[1] < 2e-4
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)


def test_as_opensees():
    """Under the same force; where the extra `opensees` is installed."""
    pytest.importorskip("openseespy")
    from ....benchmarks.opensees_beam import strike

    impact, duration = paper_impact(15.0), plasticity.STRUCK_DURATION
    run = fibre_beam.solve(impact, duration, elements=32, steps=500)
    deflection, dissipation = strike(impact.beam, run.contact_force, duration, 80, 4000)
    assert deflection == pytest.approx(run.midspan_deflection.max(), rel=1e-3)
    assert dissipation == pytest.approx(run.plastic_dissipation, rel=1e-2)
