"""Combinations that are refused, with a message that says what to change."""

import pytest

import impactlab as il
from impactlab.model.case_table import case_table
from impactlab.model.parameters import with_values

TIMOSHENKO = {"beam_model": "timoshenko"}
STRIP = TIMOSHENKO | {"contact_compliance": "strip"}
COMPLIANT = TIMOSHENKO | {"contact_compliance": "beam"}
STRESSED = TIMOSHENKO | {"contact_prestress": "bending"}
TWO = {"strike_position": 0.25, "further_spheres": "0.75 1 0"}
APART = r"1\.5 depths and widths from"

REFUSED = [
    # places and ends
    (
        {"strike_position": 0.33},
        r"^strike_position = 0\.33: .* take 0\.325 or 0\.35, or 101 nodes$",
    ),
    ({"strike_position": 0.0}, r"^Impact\.strike_position = 0\.0: must be a share"),
    ({"support_right": "free", "beam_model": "spring_mass"}, "^Impact.beam_model = 'spring_mass'"),
    ({"strike_position": 0.25, "beam_model": "rigid"}, "^Impact.beam_model = 'rigid': must be"),
    (
        STRIP | {"support_left": "free"},
        "'strip': needs ends that are pinned or clamped: set 'beam'$",
    ),
    (STRESSED | {"strike_position": 0.1}, f"'bending': needs a strike {APART} the ends"),
    (STRIP | {"strike_position": 0.1}, f"'strip': needs a strike {APART} the ends"),
    # damping and foundations
    ({"stiffness_damping": 1e-6, "beam_model": "spring_mass"}, "must be euler_bernoulli or"),
    ({"damping_ratio": 0.01, "beam_model": "rigid"}, "must be euler_bernoulli or"),
    ({"damping_ratio": 0.01}, r"damping_ratio = 0\.01: is of modes: set scheme: modal"),
    (TIMOSHENKO | {"damping_ratio": 0.01}, r"damping_ratio = 0\.01: is of modes"),
    (STRIP | {"foundation_stiffness": 3e7}, "needs a beam without foundation_stiffness: set"),
    (STRIP | {"mass_damping": 60.0}, "needs a beam without mass_damping: set"),
    (
        {"beam_model": "rigid", "foundation_stiffness": 3e7},
        "must be euler_bernoulli or elastic or timoshenko",
    ),
    (
        TIMOSHENKO | {"foundation_stiffness": 1e12, "strikes": 2},
        "^strikes = 2: must be 1 on so stiff a foundation",
    ),
    # beams that stretch
    ({"beam_model": "von_karman", "contact_compliance": "strip"}, "set beam_model: timoshenko"),
    ({"beam_model": "von_karman", "scheme": "modal"}, "'von_karman' has 'leapfrog' alone"),
    # local compliance
    ({"contact_compliance": "beam"}, "beam_model: timoshenko"),
    (STRIP | {"beam_depth": 0.07}, "as wide as deep at least"),
    (COMPLIANT | {"beam_width": 0.15}, "depth over width from 0.2 to 4"),
    (COMPLIANT | {"beam_span": 0.1}, "span of 3 depths and widths"),
    # several strikes
    (
        {"beam_model": "solid", "strikes": 2},
        "^Impact.strikes = 2: must be 1 with a model of the beam",
    ),
    ({"support_left": "free", "strikes": 2}, "^strikes = 2: must be 1 of a beam that its ends let"),
    (
        {"strikes": 2, "strike_interval": 0.9e-3},
        "^strike_interval = 900 µs: must be at least the duration",
    ),
    # several spheres
    (TWO | {"beam_model": "rigid"}, "^Impact.beam_model = 'rigid': must be"),
    (
        TWO | COMPLIANT | {"further_spheres": "0.35 1 0"},
        f"needs further_spheres {APART} each other",
    ),
    (
        TWO | {"load": "contact_patch", "scheme": "modal"},
        "^load = 'contact_patch': must be point with further_spheres and scheme: modal: change",
    ),
    (TWO | {"further_spheres": "0.33 1 0"}, "^further_spheres: lies between two of the 41 nodes"),
    (TWO | {"further_spheres": "0.25 1 0"}, "must have a place of its own each: strikes repeat"),
    (
        TWO | {"further_spheres": "0.25000000001 1 0"},
        "^further_spheres: must have a place of its own",
    ),
    (
        TWO | {"further_spheres": "0.75 1"},
        "a row needs 3 numbers: strike_position, velocity, delay",
    ),
    (
        TWO | {"further_spheres": "1 1 0"},
        "must have places above 0 and below 1 of the span, or at a",
    ),
    (
        TWO | {"further_spheres": [{"velocity": 1}]},
        r"must be a list of spheres, 1 to 8, as \[\{str",
    ),
]


@pytest.mark.parametrize(("values", "message"), REFUSED)
def test_what_cannot_be_had_together_is_refused(values, message):
    base = il.paper_impact(), il.Discretisation(nodes=41)
    with pytest.raises(ValueError, match=message):
        case_table(*with_values(*base, values), duration=1e-3)
