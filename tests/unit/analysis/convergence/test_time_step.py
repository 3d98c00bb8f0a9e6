"""The axes of space and time are judged apart, at each point of the other."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import xarray as xr

from impactlab.analysis.convergence import nodes, time_step

Build = Callable[..., xr.Dataset]
AXES = {"nodes": [51, 101, 201], "courant": [0.8, 0.1, 0.2, 0.4]}


def _h(nodes: Any) -> Any:
    return 1.0 / (nodes - 1.0)


@pytest.fixture
def both(grid_runs: Build) -> xr.Dataset:
    """An error of first order in space and of second in the time step, courant times h^2."""
    return grid_runs(
        AXES,
        peak_force=lambda nodes, courant: 7 + 5 * _h(nodes) + 1e6 * (courant * _h(nodes) ** 2) ** 2,
    )


def test_time_is_judged_at_each_number_of_nodes(both: xr.Dataset) -> None:
    found = time_step.analysis(both).sel(response="peak_force")
    assert found["time_step_gci"].dims == ("nodes",)
    np.testing.assert_allclose(found["time_step_observed_order"], 2.0, rtol=1e-6)
    # the limit is that of the nodes, not 7
    np.testing.assert_allclose(
        found["time_step_extrapolated"], 7 + 5 * _h(both["nodes"]), rtol=1e-9
    )
    np.testing.assert_allclose(found["time_step_fit_extrapolated"], 7 + 5 * _h(both["nodes"]))
    np.testing.assert_allclose(found["time_step_asymptotic_ratio"], 1.0, atol=0.01)
    assert "not that of the beam" in found["time_step_verdict"].attrs["comment"]


def test_space_is_judged_at_each_courant(both: xr.Dataset) -> None:
    found = nodes.analysis(both).sel(response="peak_force")
    assert found["nodes_gci"].dims == ("courant",)
    fine, coarse = (found["nodes_observed_order"].sel(courant=at).item() for at in (0.1, 0.8))
    assert fine == pytest.approx(1.0, abs=0.05)
    assert coarse > 1.5  # time, tied to space, spoils the order
    assert "At each courant" in found["nodes_verdict"].attrs["comment"]


@pytest.mark.parametrize(
    ("coords", "said"),
    [
        ({}, "shrinks with the square of the spacing (leapfrog):"),
        ({"scheme": "semi_implicit"}, "shrinks with the spacing (semi-implicit scheme):"),
        ({"beam_model": "timoshenko"}, "shrinks with the spacing (Timoshenko beam):"),
        (
            {"beam_model": ("velocity", ["elastic", "timoshenko"])},
            "the square of the spacing (leapfrog) or the spacing (Timoshenko beam):",
        ),
    ],
)
def test_says_what_the_time_step_follows(grid_runs: Build, coords: Any, said: str) -> None:
    runs = grid_runs(
        {"nodes": [51, 101, 201], "velocity": [1.0, 2.0]},
        peak_force=lambda nodes, velocity: velocity + _h(nodes) ** 2,
    )
    assert said in nodes.coupling(runs.assign_coords(coords))


def test_a_model_without_waves_has_a_time_step_of_its_own(grid_runs: Build) -> None:
    runs = grid_runs({"nodes": [51, 101, 201]}, peak_force=lambda nodes: nodes)
    assert nodes.coupling(runs.assign_coords(beam_model="spring_mass")) == ""


@pytest.mark.parametrize(("values", "applies"), [([0.4, 0.8], False), ([0.2, 0.4, 0.8], True)])
def test_needs_three_time_steps(grid_runs: Build, values: list[float], applies: bool) -> None:
    runs = grid_runs({"courant": values}, peak_force=lambda courant: courant)
    assert time_step.applies(runs) is applies


def test_without_limit_no_number_is_given(
    grid_runs: Build, verdicts_of: Callable[..., Any]
) -> None:
    """A strain that looks converged has no limit all the same where the beam does not harden."""
    hardening = ("beam_isotropic_hardening_modulus", "beam_kinematic_hardening_modulus")
    runs = grid_runs(
        {"velocity": [1.0, 15.0], hardening[0]: [0.0, 1e9], "nodes": [51, 101, 201, 401]},
        peak_plastic_strain=lambda velocity, nodes, **_: (velocity > 5) * (1 + 8 * _h(nodes) ** 2),
        peak_force=lambda velocity, nodes, **_: velocity * (1 + 8 * _h(nodes) ** 2),
    ).assign_coords({hardening[1]: 0.0})
    found = nodes.analysis(runs)
    strain = found.sel(response="peak_plastic_strain")
    flag = "not_convergent_by_design"
    assert verdicts_of(strain["nodes_behaviour"]) == [["at_round_off"] * 2, [flag, "monotone"]]
    assert verdicts_of(strain["nodes_verdict"])[1] == [flag, "converged_second_order"]
    assert np.isnan(strain["nodes_extrapolated"][1, 0])
    assert np.isnan(strain["nodes_gci"][1, 0])
    assert np.isinf(strain["nodes_uncertainty"][1, 0])
    assert strain["nodes_observed_order"][1, 0].item() == pytest.approx(2.0, rel=1e-6)
    assert "does not harden" in found["nodes_summary"].attrs["without_limit"]
    force = found.sel(response="peak_force")
    assert flag not in np.ravel(verdicts_of(force["nodes_behaviour"]))


def test_kinematic_hardening_brings_a_limit_back(grid_runs: Build) -> None:
    runs = grid_runs(
        {"nodes": [51, 101, 201]}, peak_plastic_strain=lambda nodes: 1 + 8 * _h(nodes) ** 2
    ).assign_coords(beam_isotropic_hardening_modulus=0.0, beam_kinematic_hardening_modulus=1e9)
    assert np.isfinite(nodes.analysis(runs)["nodes_uncertainty"]).all()
