from __future__ import annotations

from typing import Any

import pytest

from impactlab.figures.curves import plan, spread

Study = Any


def test_spread_holds_both_ends() -> None:
    assert spread(12, 6)[0] == 0
    assert spread(12, 6)[-1] == 11
    assert len(spread(12, 6)) == 6
    assert spread(2, 6) == [0, 1]


def test_curves_never_exceed_the_limit(discretisation_study: Study) -> None:
    runs, _ = discretisation_study
    for most in (1, 2, 3, 6):
        assert 1 <= len(plan(runs, "peak_force", most=most).curves) <= most


def test_two_dimensions_share_the_curves(material_study: Study) -> None:
    runs, _ = material_study
    shown = plan(runs, "peak_force", prefer=["beam_yield_stress"]).shown
    assert shown == {"beam_yield_stress": [0, 2, 3], "beam_isotropic_hardening_modulus": [0, 2]}
    alone = plan(runs, "peak_force", along=list(runs.sizes)[1:]).shown
    assert alone == {"beam_yield_stress": [0, 1, 2, 3]}


def test_every_dimension_gets_a_position(discretisation_study: Study) -> None:
    runs, _ = discretisation_study
    chosen = plan(runs, "peak_force", along=["nodes"], prefer=["velocity", "points"])
    found = runs["peak_force"].isel(chosen.runs(chosen.panels[0], chosen.curves[0]))
    assert found.dims == ("nodes",)
    assert len({curve.label for curve in chosen.curves}) == len(chosen.curves)
    assert len({curve.place for curve in chosen.curves}) == len(chosen.curves)


def test_numerics_are_held_at_the_finest(discretisation_study: Study) -> None:
    runs, _ = discretisation_study
    held = plan(runs.isel(nodes=[2, 0, 1]), "peak_force", prefer=["rule", "velocity"]).held
    assert held == {"nodes": 0, "points": 3}


def test_note_names_what_is_shown_and_held(discretisation_study: Study) -> None:
    runs, _ = discretisation_study
    note = plan(runs, "peak_force", along=["points"], prefer=["rule", "velocity"]).note(runs)
    assert "Gauss-Lobatto, Gauss-Legendre and uniform layers" in note
    assert "impact velocity = 0.99 and 15 m/s" in note
    assert "Held: nodes along the span = 401." in note


@pytest.mark.parametrize("panel", ["contact", None])
def test_a_panel_dimension_gets_no_curves(velocity_study: Study, panel: str | None) -> None:
    runs, _ = velocity_study
    chosen = plan(runs, "contact_force", panel=panel)
    assert len(chosen.panels) == (2 if panel else 1)
    assert ("contact" in chosen.shown or "contact" in chosen.held) is (panel is None)
