"""Verdicts on manufactured sequences along each axis, and what must never pass unnoticed."""

import numpy as np
import pytest

from impactlab.analysis.analyse import analyse
from impactlab.analysis.convergence import axes
from impactlab.analysis.convergence.judgement import AxisVerdict, judge

NODES = [51, 101, 201, 401, 801]
SPACINGS = 1.0 / (np.array(NODES[::-1]) - 1.0)


def _h(nodes):
    return 1.0 / (nodes - 1.0)


@pytest.mark.parametrize(
    ("finest_first", "verdict", "safety"),
    [
        (5 + 40 * SPACINGS**2, AxisVerdict.CONVERGED_SECOND_ORDER, 1.25),
        (5 + 4 * SPACINGS, AxisVerdict.CONVERGED, 1.25),
        (5 + 1e5 * SPACINGS**2, AxisVerdict.NOT_YET_CONVERGED, 1.25),
        (5 + 4 * SPACINGS**0.3, AxisVerdict.NOT_YET_CONVERGED, 3.0),
        # a scatter of 1e-4, no trend
        (5 + 5e-4 * np.array([0.0, 0.2, -0.8, 0.5, 0.0]), AxisVerdict.SETTLED, 3.0),
        (5 + 5e-4 * np.array([1.0, 0.0, 0.2, 1.0, 0.0]), AxisVerdict.SETTLED, np.nan),
        # an order of 5 is chance: judged by the range of the values
        (5 + 40 * SPACINGS**5, AxisVerdict.AT_ROUND_OFF, np.nan),
        (5 + 1e6 * SPACINGS**5, AxisVerdict.SETTLED, 3.0),
        (5 + 1e11 * SPACINGS**5, AxisVerdict.NOT_YET_CONVERGED, 3.0),
        (40 * SPACINGS**2, AxisVerdict.TENDS_TO_ZERO, 1.25),
        (1e-4 + 40 * SPACINGS**2, AxisVerdict.NOT_YET_CONVERGED, 1.25),
        (np.array([5, 6, 4, 8, 0.0]), AxisVerdict.OSCILLATORY, 3.0),
        (np.array([5, 1, 2, 1.5, 1.7]), AxisVerdict.DIVERGENT, np.nan),
        (np.full(5, 3.0), AxisVerdict.AT_ROUND_OFF, np.nan),
        (np.zeros(5), AxisVerdict.AT_ROUND_OFF, np.nan),
        # counts
        (np.array([4, 4, 4, 3, 3.0]), AxisVerdict.AT_ROUND_OFF, np.nan),
        (np.array([4, 4, 3, 3, 3.0]), AxisVerdict.NOT_YET_CONVERGED, np.nan),
        (np.array([4, 3, 3, 3, 3.0]), AxisVerdict.DIVERGENT, np.nan),
        (np.array([5, np.nan, 5.2, 5.3, 5.4]), AxisVerdict.UNDETERMINED, np.nan),
    ],
)
def test_every_verdict(finest_first, verdict, safety):
    found = judge(finest_first, SPACINGS)
    assert found.verdict is verdict
    assert found.safety_factor == pytest.approx(safety, nan_ok=True)
    assert np.isnan(found.gci) == np.isnan(safety)


@pytest.mark.parametrize(
    "finest_first",
    [
        # peak PEEQ of three Lobatto points: doubles with each halving of the spacing
        1e-3 * 2.0 ** np.arange(4, -1, -1),
        # growth by one step a halving, without limit
        1e-3 * np.arange(5, 0, -1.0),
        # so slow that neighbours agree within 1 %
        1.0 + 1e-3 * np.arange(5, 0, -1.0),
    ],
)
def test_strain_that_grows_without_limit_is_divergent(finest_first):
    found = judge(finest_first, SPACINGS)
    assert found.verdict is AxisVerdict.DIVERGENT
    assert np.isnan([found.extrapolated, found.gci]).all()


def test_slow_growth_is_never_called_converged():
    # order 0.2: the limit is 14 % off although the last step is 2 %; ten times smaller as well
    for size in (1.0, 0.1, 0.01):
        found = judge(1.0 - size * SPACINGS**0.2, SPACINGS)
        assert found.verdict is AxisVerdict.NOT_YET_CONVERGED
        assert np.isnan(found.extrapolated)
    # a coarse grid out of line costs the safety factor
    smooth = 5 + 40 * SPACINGS**2
    for coarsest in (4.9, np.nan):
        bent = np.array([*smooth[:4], coarsest])
        found = judge(bent, SPACINGS)
        assert found.verdict is AxisVerdict.CONVERGED
        assert found.gci == pytest.approx(3.0 / 1.25 * judge(smooth, SPACINGS).gci)
        assert found.extrapolated == pytest.approx(5.0)
    # a value of zero on the finest grid
    found = judge(np.array([0.0, 1e-5, 3e-5, 7e-5, 15e-5]), SPACINGS)
    assert found.verdict is AxisVerdict.NOT_YET_CONVERGED
    assert found.gci == np.inf


def test_analysis_of_a_grid(grid_runs, verdicts_of):
    runs = grid_runs(
        {"nodes": [201, 51, 401, 101], "velocity": [1.0, 15.0]},
        peak_force=lambda nodes, velocity: 1e4 * velocity * (1 + 8 * _h(nodes) ** 2),
        peak_plastic_strain=lambda nodes, velocity: 1e-5 * (velocity > 10) / _h(nodes),
    )
    found = axes.NODES.analysis(runs)
    assert found["nodes_gci"].dims == ("response", "velocity")
    force = found.sel(response="peak_force")
    np.testing.assert_allclose(force["nodes_observed_order"], 2.0, rtol=1e-6)
    np.testing.assert_allclose(force["nodes_extrapolated"], [1e4, 15e4], rtol=1e-9)
    # 1.25 x the error of the finest grid
    np.testing.assert_allclose(force["nodes_gci"], 1.25 * 8 / 400**2, rtol=1e-3)
    assert verdicts_of(found["nodes_verdict"]) == [
        ["converged_second_order", "converged_second_order"],
        ["at_round_off", "divergent"],
    ]
    assert verdicts_of(found["nodes_summary"]) == ["converged_second_order", "divergent"]
    assert found["response_units"].values.tolist() == ["N", "1"]


def test_ratio_comes_from_the_intervals(grid_runs):
    """With N for N - 1 the order of these few nodes would be off by a tenth."""
    runs = grid_runs({"nodes": [5, 9, 21]}, peak_force=lambda nodes: 7 + _h(nodes) ** 2)
    found = axes.NODES.analysis(runs)
    assert found["nodes_observed_order"].item() == pytest.approx(2.0, abs=1e-9)
    # says that time step and spacing go together
    runs = grid_runs({"nodes": [51, 101, 201]}, peak_force=lambda nodes: 5 + _h(nodes) ** 2)
    found = axes.NODES.analysis(runs)
    for name in ("nodes_observed_order", "nodes_gci", "nodes_verdict", "nodes_summary"):
        assert "space and time together" in found[name].attrs["comment"]
    # refuses repeated nodes
    runs = grid_runs({"nodes": [51, 101, 101]}, peak_force=lambda nodes: nodes)
    with pytest.raises(ValueError, match="must rise"):
        axes.NODES.analysis(runs)
    # a model without waves has a time step of its own
    runs = grid_runs({"nodes": [51, 101, 201]}, peak_force=lambda nodes: nodes)
    assert axes.coupling(runs.assign_coords(beam_model="spring_mass")) == ""


def test_a_failed_run_gives_no_number(grid_runs, verdicts_of):
    runs = grid_runs(
        {"velocity": [1.0, 5.0], "nodes": [51, 101, 201]},
        peak_force=lambda velocity, nodes: velocity + 0.1 * _h(nodes) ** 2,
        impulse=lambda velocity, nodes: velocity + 0.1 * _h(nodes) ** 2,
    )
    runs["peak_force"][1, 2] = np.nan
    runs["status"][1, 2] = 32
    found = axes.NODES.analysis(runs)
    assert verdicts_of(found["nodes_summary"]) == ["undetermined", "converged_second_order"]
    gone = found.sel(response="peak_force", velocity=5.0)
    for name in ("nodes_observed_order", "nodes_extrapolated", "nodes_gci"):
        assert np.isnan(gone[name])
    # a number from a diverged run is not used
    runs = grid_runs({"nodes": [51, 101, 201]}, peak_force=lambda nodes: 5 + _h(nodes) ** 2)
    runs["status"][0] = 1
    found = axes.NODES.analysis(runs)
    assert verdicts_of(found["nodes_verdict"]) == ["undetermined"]


@pytest.mark.parametrize(("nodes", "applies"), [([51, 101], False), ([51, 101, 201], True)])
def test_needs_three_grids(grid_runs, nodes, applies):
    runs = grid_runs({"nodes": nodes}, peak_force=lambda nodes: nodes)
    assert ("nodes_verdict" in analyse(runs)) is applies


AXES = {"nodes": [51, 101, 201], "courant": [0.8, 0.1, 0.2, 0.4]}


@pytest.fixture
def both(grid_runs):
    """An error of first order in space and of second in the time step, courant times h^2."""
    return grid_runs(
        AXES,
        peak_force=lambda nodes, courant: 7 + 5 * _h(nodes) + 1e6 * (courant * _h(nodes) ** 2) ** 2,
    )


def test_time_is_judged_at_each_number_of_nodes(both):
    found = axes.TIME_STEP.analysis(both).sel(response="peak_force")
    assert found["time_step_gci"].dims == ("nodes",)
    np.testing.assert_allclose(found["time_step_observed_order"], 2.0, rtol=1e-6)
    # the limit is that of the nodes, not 7
    np.testing.assert_allclose(
        found["time_step_extrapolated"], 7 + 5 * _h(both["nodes"]), rtol=1e-9
    )
    np.testing.assert_allclose(found["time_step_fit_extrapolated"], 7 + 5 * _h(both["nodes"]))
    np.testing.assert_allclose(found["time_step_asymptotic_ratio"], 1.0, atol=0.01)
    assert "not that of the beam" in found["time_step_verdict"].attrs["comment"]
    # space is judged at each courant
    found = axes.NODES.analysis(both).sel(response="peak_force")
    assert found["nodes_gci"].dims == ("courant",)
    fine, coarse = (found["nodes_observed_order"].sel(courant=at).item() for at in (0.1, 0.8))
    assert fine == pytest.approx(1.0, abs=0.05)
    assert coarse > 1.5  # time, tied to space, spoils the order
    assert "At each courant" in found["nodes_verdict"].attrs["comment"]


@pytest.mark.parametrize(
    ("coords", "said"),
    [
        ({}, "shrinks with the square of the spacing (leapfrog):"),
        ({"scheme": "modal"}, "shrinks with the spacing (modal scheme):"),
        ({"beam_model": "timoshenko"}, "shrinks with the spacing (Timoshenko beam):"),
        (
            {"beam_model": ("velocity", ["elastic", "timoshenko"])},
            "the square of the spacing (leapfrog) or the spacing (Timoshenko beam):",
        ),
    ],
)
def test_says_what_the_time_step_follows(grid_runs, coords, said):
    runs = grid_runs(
        {"nodes": [51, 101, 201], "velocity": [1.0, 2.0]},
        peak_force=lambda nodes, velocity: velocity + _h(nodes) ** 2,
    )
    assert said in axes.coupling(runs.assign_coords(coords))


@pytest.mark.parametrize(("values", "applies"), [([0.4, 0.8], False), ([0.2, 0.4, 0.8], True)])
def test_needs_three_time_steps(grid_runs, values, applies):
    runs = grid_runs({"courant": values}, peak_force=lambda courant: courant)
    assert ("time_step_verdict" in analyse(runs)) is applies


def test_without_limit_no_number_is_given(grid_runs, verdicts_of):
    """A strain that looks converged has no limit all the same where the beam does not harden."""
    hardening = ("beam_isotropic_hardening_modulus", "beam_kinematic_hardening_modulus")
    runs = grid_runs(
        {"velocity": [1.0, 15.0], hardening[0]: [0.0, 1e9], "nodes": [51, 101, 201, 401]},
        peak_plastic_strain=lambda velocity, nodes, **_: (velocity > 5) * (1 + 8 * _h(nodes) ** 2),
        peak_force=lambda velocity, nodes, **_: velocity * (1 + 8 * _h(nodes) ** 2),
    ).assign_coords({hardening[1]: 0.0})
    found = axes.NODES.analysis(runs)
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
    # kinematic hardening brings a limit back
    runs = grid_runs(
        {"nodes": [51, 101, 201]}, peak_plastic_strain=lambda nodes: 1 + 8 * _h(nodes) ** 2
    ).assign_coords(beam_isotropic_hardening_modulus=0.0, beam_kinematic_hardening_modulus=1e9)
    assert np.isfinite(axes.NODES.analysis(runs)["nodes_uncertainty"]).all()
