"""The elastic beam under Hertz contact against the modal series (Timoshenko 1913)."""

from dataclasses import replace

import numpy as np
import pytest

import impactlab as il
from impactlab.reference.modal import solve
from impactlab.reference.timoshenko import timoshenko_impact

CASES = {
    "paper": (replace(il.paper_impact(0.99, "hertz"), gravity=0.0), 0.4e-3),
    "paper with gravity": (il.paper_impact(0.99, "hertz"), 0.4e-3),
    "timoshenko": (timoshenko_impact(), 0.3e-3),
}


@pytest.fixture(scope="module", params=CASES)
def case(request):
    impact, duration = CASES[request.param]
    series = solve(impact, duration)
    runs = {
        nodes: il.simulate(
            impact, il.Discretisation(nodes=nodes, points=3), duration=duration, samples=401
        )
        for nodes in (101, 201, 401)
    }
    return series, runs


def errors(series, run):
    """Relative errors of peak force, contact duration and deflection history."""
    expected = series.at("midspan_deflection", run.time.values)
    difference = np.abs(run.midspan_deflection.values - expected).max()
    return np.array(
        [
            run.peak_force.item() / series.peak_force - 1,
            run.contact_duration.item() / series.contact_duration - 1,
            difference / np.abs(expected).max(),
        ]
    )


def test_agree_within_1e_3_at_201_nodes(case):
    series, runs = case
    assert np.abs(errors(series, runs[201])).max() < 1e-3


def test_errors_fall_with_second_order(case):
    series, runs = case
    by_nodes = {nodes: np.abs(errors(series, run)) for nodes, run in runs.items()}
    order = np.log2(by_nodes[201] / by_nodes[401])
    assert order == pytest.approx(2, abs=0.15)
    assert np.log2(by_nodes[101] / by_nodes[201]) == pytest.approx(2, abs=0.3)
