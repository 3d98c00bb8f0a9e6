"""Figures of histories, profiles and grids: what is drawn is what is stored."""

import numpy as np
import pytest
import xarray as xr
from drawings import is_guide, panel, points

from impactlab.figures.catalogue import CATALOGUE
from impactlab.figures.curves import broken, coincide, plan
from impactlab.figures.scales import spread
from impactlab.solver.contact import CONTACT_LAWS


def test_spread_holds_both_ends():
    assert spread(12, 6)[0] == 0
    assert spread(12, 6)[-1] == 11
    assert len(spread(12, 6)) == 6
    assert spread(2, 6) == [0, 1]
    # a jump is not joined and a smooth curve is
    speed = np.array([15.0, 16.0, 17.0, 18.0, 19.0, 20.0])
    x, y = broken(speed, np.array([0.155, 0.155, 0.157, 0.276, 0.272, 0.27]))
    assert np.flatnonzero(np.isnan(y)).tolist() == [3]
    assert np.delete(x, 3).tolist() == speed.tolist()
    assert broken(speed, speed**-0.2)[1].size == 6


def test_curves_never_exceed_the_limit(discretisation_study):
    runs, _ = discretisation_study
    for most in (1, 2, 3, 6):
        assert 1 <= len(plan(runs, "peak_force", most=most).curves) <= most
    # every dimension gets a position
    chosen = plan(runs, "peak_force", along=["nodes"], prefer=["velocity", "points"])
    found = runs["peak_force"].isel(chosen.panels[0].where | chosen.curves[0].where)
    assert found.dims == ("nodes",)
    assert len({curve.label for curve in chosen.curves}) == len(chosen.curves)
    assert len({curve.place for curve in chosen.curves}) == len(chosen.curves)
    # numerics are held at the finest
    held = plan(runs.isel(nodes=[2, 0, 1]), "peak_force", prefer=["rule", "velocity"]).held
    assert held == {"nodes": 0, "points": 3}
    # note names what is shown and held
    note = plan(runs, "peak_force", along=["points"], prefer=["rule", "velocity"]).note(runs)
    assert "Gauss-Lobatto, Gauss-Legendre and uniform layers" in note
    assert "impact velocity = 0.99 and 15 m/s" in note
    assert "Held: nodes along the span = 401." in note


def test_two_dimensions_share_the_curves(material_study):
    runs, _ = material_study
    shown = plan(runs, "peak_force", prefer=["beam_yield_stress"]).shown
    assert shown == {"beam_yield_stress": [0, 2, 3], "beam_isotropic_hardening_modulus": [0, 2]}
    alone = plan(runs, "peak_force", along=list(runs.sizes)[1:]).shown
    assert alone == {"beam_yield_stress": [0, 1, 2, 3]}


@pytest.mark.parametrize("panel", ["contact", None])
def test_a_panel_dimension_gets_no_curves(velocity_study, panel):
    runs, _ = velocity_study
    chosen = plan(runs, "contact_force", panel=panel)
    assert len(chosen.panels) == (2 if panel else 1)
    assert ("contact" in chosen.shown or "contact" in chosen.held) is (panel is None)


NONE = xr.Dataset()
STRONGE = CONTACT_LAWS["stronge"].title


def _curves(figure, title=""):
    """Curves of the panel whose title starts so, by label; guides are none."""
    axes = panel(figure, title)
    return {str(line.get_label()): line for line in axes.lines if not is_guide(line)}


def test_force_history_shows_the_stored_numbers(velocity_study):
    runs, _ = velocity_study
    stored = runs["contact_force"].sel(velocity=20.0, contact="stronge")
    for name, title in {"force_history": f"{STRONGE}, 20 m/s", "first_contact": "Stronge"}.items():
        curves = _curves(CATALOGUE[name].plot(runs, NONE), title)
        time, force = points(curves["20 m/s"])
        np.testing.assert_allclose(time, 1e3 * runs["time"])
        np.testing.assert_allclose(force, 1e-3 * stored)
    # first contact ends with the longest first one
    first = CATALOGUE["first_contact"].plot(runs, NONE).axes[0].get_xlim()[1]
    whole = CATALOGUE["force_history"].plot(runs, NONE).axes[0].get_xlim()[1]
    longest = 1e3 * float(runs["contact_duration"].max())
    assert first == pytest.approx(1.05 * longest, rel=0.03)
    assert first < whole
    # force indentation breaks between contacts
    curve = _curves(CATALOGUE["force_indentation"].plot(runs, NONE), "Hertz")["20 m/s"]
    depth, force = points(curve)
    loops = np.diff(np.isfinite(force).astype(int), prepend=0, append=0)
    assert (loops == 1).sum() == 2
    np.testing.assert_array_equal(np.isnan(depth), np.isnan(force))
    assert force[np.isfinite(force)][0] == 0.0


def test_force_history_has_a_panel_a_run_and_leaves_failed_ones_empty(velocity_study, failing):
    runs, _ = velocity_study
    broken = failing(runs, {"velocity": -1, "contact": 1})
    figure = CATALOGUE["force_history"].plot(broken, NONE)
    assert len(figure.axes) == 12
    assert [len(axes.lines) for axes in figure.axes] == 11 * [1] + [0]
    failed = panel(figure, f"{STRONGE}, 20 m/s")
    assert [text.get_text() for text in failed.texts] == ["no finite values"]
    assert f"No curve for 20 m/s, {STRONGE}." in CATALOGUE["force_history"].caption(broken, NONE)
    # force history ends with the last contact
    runs["contact_force"][0, 0] = runs["contact_force"][0, 0].where(runs["time"] < 1e-4, 0.0)
    axes = panel(CATALOGUE["force_history"].plot(runs, NONE), "Hertz, 0.25 m/s")
    assert axes.get_xlim()[1] == pytest.approx(0.1, rel=0.1)
    longest = 3e3 * float(runs["contact_duration"].max())
    assert axes.figure.axes[1].get_xlim()[1] == pytest.approx(1.05 * longest, rel=0.1)


def test_the_guide_of_contact_duration_has_hertzs_slope(velocity_study, failing):
    runs, _ = velocity_study
    lines = panel(CATALOGUE["contact_duration"].plot(runs, NONE), "").lines
    (guide,) = (points(line) for line in lines if is_guide(line))
    x, y = guide
    assert x.tolist() == [0.25, 20.0]
    assert np.log(y[1] / y[0]) / np.log(x[1] / x[0]) == pytest.approx(-0.2)
    assert y[0] > 1e3 * float(runs["contact_duration"].max())
    # guides are in the legend
    legend = CATALOGUE["contact_duration"].plot(velocity_study[0], NONE).legends[0]
    assert [text.get_text() for text in legend.get_texts()] == ["Hertz", STRONGE, "slope −1/5"]
    # contact duration leaves a gap
    broken = failing(runs, {"velocity": 3, "contact": 0})
    curves = _curves(CATALOGUE["contact_duration"].plot(broken, NONE))
    assert set(curves) == {"Hertz", STRONGE}
    speed, duration = points(curves["Hertz"])
    np.testing.assert_array_equal(speed, runs["velocity"])
    assert np.flatnonzero(np.isnan(duration)).tolist() == [3]
    assert duration[0] == pytest.approx(1e3 * float(runs["contact_duration"][0, 0]))


def test_restitution_is_the_stored_one_and_leaves_a_gap(velocity_study, failing):
    runs, _ = velocity_study
    broken = failing(runs, {"velocity": 3, "contact": 0})
    figure = CATALOGUE["restitution_velocity"].plot(broken, NONE)
    curves = _curves(figure)
    assert set(curves) == {"Hertz", STRONGE}
    speed, restitution = points(curves["Hertz"])
    np.testing.assert_array_equal(speed, runs["velocity"])
    stored = runs["restitution"].sel(contact="hertz").values
    np.testing.assert_allclose(np.delete(restitution, 3), np.delete(stored, 3))
    assert np.isnan(restitution[3])
    low, high = figure.axes[0].get_ylim()
    assert low <= 0.0 < 1.0 <= high


def test_plastic_strain_is_the_largest_over_the_depth_in_percent(velocity_study):
    runs, _ = velocity_study
    figure = CATALOGUE["plastic_strain"].plot(runs, NONE)
    x, strain = points(_curves(figure, "Hertz")["15 m/s"])
    stored = runs["equivalent_plastic_strain"].sel(velocity=15.0, contact="hertz").max("z")
    np.testing.assert_allclose(x, 1e3 * runs["x"])
    np.testing.assert_allclose(np.nan_to_num(strain), 100 * stored)
    # plastic strain marks one depth and the papers limit
    figure = CATALOGUE["plastic_strain"].plot(runs, NONE)
    legend = [text.get_text() for text in figure.legends[0].get_texts()]
    assert legend[-2:] == ["one beam depth from the impact", "0.2 %, the paper's limit"]
    axes = figure.axes[0]
    guides = [points(line) for line in axes.lines if is_guide(line)]
    marks = sorted(float(x[0]) for x, y in guides if x[0] == x[1])
    assert marks == pytest.approx([390.0 - 27.8, 390.0 + 27.8])
    assert [float(y[0]) for x, y in guides if y[0] == y[1]] == [0.2]
    # plastic strain over the depth is in the worst section
    figure = CATALOGUE["plastic_strain_depth"].plot(runs, NONE)
    strain, depth = points(_curves(figure, "Hertz")["20 m/s"])
    stored = runs["equivalent_plastic_strain"].sel(velocity=20.0, contact="hertz")
    assert np.nanmax(strain) == pytest.approx(100 * float(stored.max()))
    np.testing.assert_allclose(depth, 1e3 * runs["z"])
    low, high = figure.axes[0].get_ylim()
    assert low > high  # downwards


def test_elastic_velocities_are_named_not_drawn(velocity_study, failing):
    runs, _ = velocity_study
    broken = failing(runs, {"velocity": 0, "contact": 0})
    figure = CATALOGUE["plastic_strain"].plot(broken, NONE)
    assert set(_curves(figure, "Hertz")) == {f"{v} m/s" for v in ("5", "7.5", "10", "15", "20")}
    caption = CATALOGUE["plastic_strain"].caption(broken, NONE)
    assert "No fibre yields at impact velocity = 0.25, 0.99 and 2 m/s." in caption
    assert "1 of 16 runs is missing" in caption
    # an elastic study says so
    runs["equivalent_plastic_strain"] *= 0.0
    for name in ("plastic_strain", "plastic_strain_depth"):
        figure = CATALOGUE[name].plot(runs, NONE)
        assert figure.axes[0].texts[0].get_text() == "no plastic strain"


def test_histories_without_a_velocity_dimension(velocity_study):
    runs, _ = velocity_study
    one = runs.isel(velocity=-1, contact=0)
    for name in (
        "first_contact",
        "force_history",
        "force_indentation",
        "plastic_strain",
        "plastic_strain_depth",
    ):
        figure = CATALOGUE[name].plot(one, NONE)
        assert list(_curves(figure)) == ["_only"]
        assert figure.legends == [] or name == "plastic_strain"  # its guides


def test_parameter_effects_draws_every_response(material_study, failing):
    runs, _ = material_study
    figure = CATALOGUE["parameter_effects"].plot(runs, NONE)
    stress, force = points(_curves(figure, "Peak force (kN)")["1000 MPa, 210 GPa"])
    stored = runs["peak_force"].sel(beam_isotropic_hardening_modulus=1e9, beam_youngs_modulus=210e9)
    np.testing.assert_allclose(stress, 1e-6 * runs["beam_yield_stress"])
    np.testing.assert_allclose(force, 1e-3 * stored)
    assert len(_curves(figure, "Restitution")) == 6
    # parameter effects leaves gaps
    broken = failing(runs, {"beam_youngs_modulus": 0, "beam_yield_stress": 2})
    figure = CATALOGUE["parameter_effects"].plot(broken, NONE)
    _, force = points(_curves(figure, "Peak force")["0 MPa, 200 GPa"])
    assert np.flatnonzero(np.isnan(force)).tolist() == [2]
    assert "3 of 24 runs are missing" in CATALOGUE["parameter_effects"].caption(broken, NONE)


def test_the_flight_after_the_last_contact_sets_no_scale(velocity_study):
    runs = velocity_study[0].copy(deep=True)
    for name in ("sphere_displacement", "indentation"):
        runs[name][..., -1] = -1.0  # a metre away
    axes = panel(CATALOGUE["displacement_history"].plot(runs, NONE), "Hertz")
    assert axes.get_ylim()[0] > -500.0


def test_a_zigzag_is_not_joined_and_a_wave_is():
    x = np.arange(8.0)
    zigzag = np.array([0.1, 9.0, 9.0, 0.1, 7.0, 0.1, 0.1, 0.1])
    _, gapped = broken(x, zigzag)
    assert np.isnan(gapped[1::2]).all()
    np.testing.assert_array_equal(gapped[::2], zigzag)
    x = np.linspace(0.0, 6.0, 40)
    np.testing.assert_array_equal(broken(x, np.sin(x))[1], np.sin(x))


def test_a_covered_curve_has_rings_around_the_markers_on_top(material_study):
    runs, analysis = material_study
    values = runs["peak_force"]
    runs["peak_force"] = 0 * values + values.isel(beam_isotropic_hardening_modulus=0)
    axes = panel(CATALOGUE["parameter_effects"].plot(runs, analysis), "Peak force (kN)")
    first, *others = axes.lines
    assert first.get_markerfacecolor() == first.get_color()
    rings = [line for line in others if line.get_markerfacecolor() == "none"]
    assert rings
    assert all(line.get_markersize() > first.get_markersize() for line in rings)
    # curves that are far apart, though not over the range of an outlier, are not covered
    y = np.array([1.0, 2.0, 3.0, 1e4])
    assert coincide(y, 1.001 * y)
    assert not coincide(y, np.array([1.2, 2.2, 3.3, 1e4]))
