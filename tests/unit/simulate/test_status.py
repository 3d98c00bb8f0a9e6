"""A response is missing where the status says why; remarks leave the numbers standing."""

from dataclasses import replace

import numpy as np
import pytest

import impactlab as il
from impactlab.model.parameters import with_values
from impactlab.solver.contact import finite_element
from impactlab.variables import (
    FAILURES,
    OUTSIDE_DATA,
    RESPONSES,
    STATUS_FLAGS,
    WARNINGS,
    reasons,
)

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")

IMPACT = il.paper_impact(15.0)
GRID = il.Discretisation(nodes=21, points=5)
BITS = {name: bit for name, (bit, _) in STATUS_FLAGS.items()}


def test_a_run_in_which_the_contact_law_creates_energy_says_so():
    """Stronge's law at 20 and at 990 mm/s: within and above 2.673 times the yield indentation."""
    run = il.simulate(il.paper_impact(0.02), GRID, duration=4e-3)
    assert run.remarks.item() & WARNINGS["contact_created_energy"][0]
    assert run.contact_dissipation < 0
    assert "creates energy" in run.contact_dissipation.attrs["comment"]
    assert "created energy" in reasons(run.remarks.item(), WARNINGS)[0]
    assert il.simulate(il.paper_impact(0.99), GRID, duration=4e-3).remarks == 0
    assert reasons(0, WARNINGS) == []


DEFAULT_LAW = replace(il.paper_impact(contact="finite_element"), beam_model="timoshenko")


@pytest.mark.parametrize(
    ("cause", "inside", "outside"),
    [
        ("yield_ratio", {"beam_yield_stress": 80e6}, {"beam_yield_stress": 70e6}),
        ("poissons_ratio", {"beam_poissons_ratio": 0.06}, {"beam_poissons_ratio": 0.04}),
        ("poissons_ratio", {"beam_poissons_ratio": 0.44}, {"beam_poissons_ratio": 0.46}),
        (
            "hardening",
            {"beam_isotropic_hardening_modulus": 10e9},
            {"beam_isotropic_hardening_modulus": 11e9},
        ),
        (
            "hardening",  # here it unloads by yielding in reverse
            {"velocity": 5.0, "beam_yield_stress": 85e6, "beam_kinematic_hardening_modulus": 5e9},
            {"velocity": 5.0, "beam_yield_stress": 85e6, "beam_kinematic_hardening_modulus": 10e9},
        ),
        ("sphere_yield", {"sphere_yield_stress": 350e6}, {"sphere_yield_stress": 330e6}),
        (
            "stiffness_ratio",
            {"sphere_youngs_modulus": 630e9},
            {"beam_youngs_modulus": 60e9, "beam_yield_stress": 1e8, "sphere_youngs_modulus": 630e9},
        ),
        (
            "stiffness_ratio",
            {"sphere_youngs_modulus": 70e9, "beam_yield_stress": 150e6},
            {"sphere_youngs_modulus": 60e9, "beam_yield_stress": 150e6},
        ),
        ("contact_circle", {"velocity": 15.0}, {"velocity": 20.0}),
        (
            "contact_circle",
            {"velocity": 3.6, "beam_depth": 0.02, "beam_width": 0.02},
            {"velocity": 3.6, "beam_depth": 0.02, "beam_width": 0.008},
        ),
        (
            "contact_force",
            {"velocity": 12.0, "beam_depth": 0.02, "beam_width": 0.03},
            {"velocity": 15.0, "beam_depth": 0.02, "beam_width": 0.03},
        ),
    ],
)
def test_an_input_outside_the_data_of_the_contact_law_is_named(cause, inside, outside):
    """Whichever it is, and it alone; not of another law, nor of a contact that stays elastic."""
    bit = WARNINGS[f"{cause}_outside_data"][0]

    def remarks(values, **change):
        impact, grid = with_values(DEFAULT_LAW, GRID, {"contact_compliance": "beam"} | values)
        return il.simulate(replace(impact, **change), grid, duration=0.3e-3).remarks.item()

    assert remarks(inside) == 0
    assert remarks(outside) & OUTSIDE_DATA == bit
    if cause in ("contact_circle", "contact_force"):
        assert remarks(outside | {"contact_compliance": "half_space"}) == 0
        return
    assert remarks(outside, contact="stronge") & OUTSIDE_DATA == 0
    assert remarks(outside, velocity=1e-5) & OUTSIDE_DATA == 0


def test_metals_outside_the_data_are_named_from_the_first_dent_on():
    """Which comes before delta_y, for metals of a low Poisson's ratio."""
    metal = replace(DEFAULT_LAW.beam.material, poissons_ratio=0.02)
    impact = replace(DEFAULT_LAW, beam=replace(DEFAULT_LAW.beam, material=metal))
    bit = WARNINGS["poissons_ratio_outside_data"][0]
    assert (
        not il.simulate(replace(impact, velocity=0.005), GRID, duration=1e-3).remarks.item() & bit
    )
    run = il.simulate(replace(impact, velocity=0.01), GRID, duration=1e-3)
    assert 0.0 < run.permanent_indentation < 0.02 * run.maximum_indentation
    assert run.remarks.item() & bit


def test_a_dent_that_is_shallow_beside_the_indentation_is_remarked():
    bit = WARNINGS["shallow_dent"][0]
    for velocity, contact, remarked in (
        (0.02, DEFAULT_LAW.contact, True),
        (0.05, DEFAULT_LAW.contact, False),
        (0.02, "kogut_etsion", False),
    ):
        run = il.simulate(
            replace(DEFAULT_LAW, velocity=velocity, contact=contact), GRID, duration=8e-3
        )
        dent = float(run.permanent_indentation / run.maximum_indentation)
        assert 0.0 < dent < (0.15 if velocity > 0.02 else finite_element.LEAST_DENT)
        assert bool(run.remarks.item() & bit) == remarked


def test_words_of_remarks_have_the_limits_of_the_law():
    for names, cause in (
        ("LEAST_RATIO LARGEST_RATIO", "yield_ratio"),
        ("LEAST_POISSONS_RATIO LARGEST_POISSONS_RATIO", "poissons_ratio"),
        ("LARGEST_HARDENING", "hardening"),
        ("LEAST_HARDNESS", "sphere_yield"),
        ("LEAST_STIFFNESS LARGEST_STIFFNESS", "stiffness_ratio"),
        ("LARGEST_CIRCLE LARGEST_CIRCLE_ACROSS", "contact_circle"),
        ("LARGEST_FORCE", "contact_force"),
        ("LEAST_DENT", "shallow_dent"),
    ):
        words = (WARNINGS.get(cause) or WARNINGS[f"{cause}_outside_data"])[1]
        for name in names.split():
            assert f" {getattr(finite_element, name):g}" in words, name


WHOLE_RUN = {"diverged", "energy_out_of_balance", "earlier_strike_unfinished", "stopped"}
"""The last is of the 3-D model alone, the one before of several strikes."""
OF_STRIKES = {"not_steady", "no_shakedown"}
"""Of several strikes, in studies that list what they explain."""


def flags(run):
    return {name for name, bit in BITS.items() if run.status.item() & bit}


def test_a_response_is_missing_exactly_where_a_flag_says_so():
    """Over durations from before the first peak to long after the rebound."""
    seen = set()
    for contact in ("hertz", "stronge"):
        for duration in np.geomspace(2e-5, 20e-3, 16):
            run = il.simulate(replace(IMPACT, contact=contact), GRID, duration=float(duration))
            seen |= flags(run) or {"none"}
            for name, entry in RESPONSES.items():
                missing = entry.missing in flags(run)
                assert np.isnan(run[name].item()) == missing, (name, duration)
    assert seen == {*FAILURES, "none"} - WHOLE_RUN - OF_STRIKES


def test_flags_come_off_as_the_run_grows_longer():
    impact, grid = il.paper_impact(0.99), il.Discretisation(nodes=41, points=3)
    whole = il.simulate(impact, grid, duration=10e-3)
    assert flags(whole) == set()
    peak, end = whole.time_of_peak_force.item(), whole.contact_duration.item()
    loading = il.simulate(impact, grid, duration=0.7 * peak)
    assert flags(loading) == set(FAILURES) - WHOLE_RUN - OF_STRIKES
    unloading = il.simulate(impact, grid, duration=0.5 * (peak + end))
    assert flags(loading) - flags(unloading) == {"indentation_still_growing"}
    assert unloading.peak_force.item() == pytest.approx(whole.peak_force.item(), rel=1e-2)
    after = il.simulate(impact, grid, duration=1.02 * end)
    assert not {"first_contact_unfinished", "in_contact_at_end"} & flags(after)
    assert after.contact_duration.item() == pytest.approx(end, rel=1e-2)
