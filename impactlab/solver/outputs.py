"""The results of a run: its responses, and the bits that explain or qualify them.

A new response takes an entry in RESPONSES, and a line in responses.py that computes it. This file
stays free of numba, so that responses can be listed without compiling anything.

Of repeated strikes, a quantity y does not grow from strike m on if |y_n - y_(n-1)| <= NO_GROWTH
|y_n|, but for round-off, for all n from m to the last one; compiled kernels fill in the series.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from impactlab.solver.types import Array

# The bits of `status` (in words: impactlab.variables.STATUS_FLAGS). They say why an answer is
# missing, except OUTSIDE_CONTACT_LAW, which leaves every answer and marks them.
DIVERGED = 1
FIRST_CONTACT_UNFINISHED = 2
IN_CONTACT_AT_END = 4
SPHERE_NOT_LEAVING = 8
DEFLECTION_STILL_GROWING = 16
INDENTATION_STILL_GROWING = 32
ENERGY_OUT_OF_BALANCE = 64
OUTSIDE_CONTACT_LAW = 128
EARLIER_STRIKE_UNFINISHED = 512  # 256: of the 3-D model (impactlab.variables)

# The bits of `remarks`: warnings on answers that are there (impactlab.variables.WARNINGS).
CONTACT_CREATED_ENERGY = 1
CONTACT_LEFT_A_BULGE = 2
# The input that lies outside the data of the law finite_element and of the corrections.
YIELD_RATIO_OUTSIDE_DATA = 4
POISSONS_RATIO_OUTSIDE_DATA = 8
HARDENING_OUTSIDE_DATA = 16
SPHERE_YIELD_OUTSIDE_DATA = 32
STIFFNESS_RATIO_OUTSIDE_DATA = 64
CONTACT_CIRCLE_OUTSIDE_DATA = 128
STRUCK_NEAR_END = 256
# What the beam model lacks under the sphere, by shape of the section.
WALL_MAY_DENT = 512
ROUND_TOP = 1024
SKIN_MAY_GIVE = 4096
# The axial force of ends that hold the axis, in other models than von_karman.
STRETCHING_LEFT_OUT = 2048
# Runs with several strikes of which the last one still leaves more; bits of `status`, too.
NO_SHAKEDOWN = 8192
NOT_STEADY = 16384
# A beam whose plastic strains let it rest in a second shape, too.
SECOND_REST = 32768
# Half a beam whose rest is symmetric, while the whole one would buckle.
UNSTABLE_REST = 65536
# Answers in which the law finite_element, or the corrections, are known to be off.
SHALLOW_DENT = 131072
CONTACT_FORCE_OUTSIDE_DATA = 262144

SHORT_PAUSE = 0.05
"""Pauses shorter than this share of the first contact until then do not end it."""


@dataclass(frozen=True)
class Response:
    """A scalar answer of a run: its name, unit (UDUNITS) and meaning.

    missing: the status flag that explains why it is NaN (besides those of the whole run).
    comment: what a reader of the number has to know. beam_models_only: the 3-D model has none.
    """

    name: str
    units: str
    long_name: str
    missing: str | None = None
    comment: str | None = None
    beam_models_only: bool = False


RESPONSES = (
    Response("peak_force", "N", "largest contact force", "indentation_still_growing"),
    Response(
        "time_of_peak_force",
        "s",
        "time of the largest contact force",
        "indentation_still_growing",
    ),
    Response(
        "contact_duration",
        "s",
        "duration of the first contact",
        "first_contact_unfinished",
        "until the first pause that is at least a twentieth as long as the contact before: whether "
        "the surfaces part for a moment depends on a hair's breadth",
    ),
    Response("number_of_contacts", "1", "contacts begun within the duration"),
    Response("total_contact_time", "s", "time in contact, all contacts", "in_contact_at_end"),
    Response("maximum_indentation", "m", "largest indentation", "indentation_still_growing"),
    Response(
        "permanent_indentation",
        "m",
        "indentation left after the last contact",
        "in_contact_at_end",
        "below zero where the contact law itself leaves a bulge, as Stronge's does for largest "
        "indentations of 1 to 1.998 times that of first yield; `remarks` says so, too",
    ),
    Response(
        "maximum_deflection", "m", "largest deflection under the sphere", "deflection_still_growing"
    ),
    Response("impulse", "N s", "impulse of the contact force, all contacts", "in_contact_at_end"),
    Response(
        "mean_force",
        "N",
        "mean contact force: impulse over the time in contact",
        "in_contact_at_end",
    ),
    Response(
        "rebound_velocity",
        "m s-1",
        "sphere's velocity away from the beam when the last contact ends",
        "sphere_not_leaving",
    ),
    Response(
        "restitution",
        "1",
        "coefficient of restitution (rebound over impact velocity)",
        "sphere_not_leaving",
    ),
    Response("peak_plastic_strain", "1", "largest equivalent plastic strain (PEEQ)"),
    Response(
        "remote_plastic_strain",
        "1",
        "largest PEEQ farther than one beam depth from the impact",
    ),
    Response("plastic_zone_length", "m", "length of beam with a PEEQ above 1e-5 in the section"),
    Response(
        "contact_dissipation",
        "J",
        "energy dissipated in the contact",
        "in_contact_at_end",
        "below zero where the contact law itself creates energy, as Stronge's does for largest "
        "indentations of 1 to 2.673 times that of first yield; `remarks` says so, too",
        beam_models_only=True,
    ),
    Response("plastic_dissipation", "J", "energy dissipated in the fibres"),
    Response("energy_error", "1", "largest energy imbalance over the initial kinetic energy"),
)
"""Every response, in the order of datasets and reports."""

SERIES = (
    "permanent_indentation",
    "residual_deflection",
    "peak_force",
    "restitution",
    "rebound_velocity",
    "contact_dissipation",
    "plastic_dissipation",
)
"""What a run keeps of each strike."""

RESPONSE = np.dtype(
    (
        np.record,
        [(name, np.int64) for name in ("status", "remarks")]
        + [(response.name, float) for response in RESPONSES],
    )
)
"""Record type of the answers: the bits of status and warnings, and the responses."""


def blank(runs: int) -> Array:
    """Return the RESPONSE records of as many runs, every response missing and no bit set."""
    records = np.zeros(runs, RESPONSE)
    for response in RESPONSES:
        records[response.name] = np.nan
    return records


NO_GROWTH = 1e-3
"""Largest growth in a strike, over what strikes have left so far, that counts as none."""
GROWING = {
    "steady_strike": (("permanent_indentation", "residual_deflection"), NOT_STEADY),
    "shakedown_strike": (("permanent_indentation", "plastic_dissipation"), NO_SHAKEDOWN),
}
"""Strikes from which on quantities do not grow: which, and the bit of both flags without one."""
_WHOLE_RUN = DIVERGED | ENERGY_OUT_OF_BALANCE | EARLIER_STRIKE_UNFINISHED
"""Bits of runs without any response."""
_ROUND_OFF = 1e-12
"""Growth that is none, in m or J: of a beam at rest to which nothing happened."""


def by_strike(cases: Array, columns: dict[str, Array], series: Array) -> dict[str, Array]:
    """Return the series by name, (R, strikes), GROWING, (R,), and both flags with its bits.

    cases: CASE records. columns: answers so far, (R,). series: (R, strikes, len(SERIES)).
    """
    strikes = cases["strikes"]
    values = dict(zip(SERIES, np.moveaxis(series, 2, 0), strict=True))
    answers = {f"{name}_over_strikes": value for name, value in values.items()}
    lost, growing = columns["status"] & _WHOLE_RUN != 0, np.zeros_like(columns["status"])
    values["residual_deflection"] = _at_touch(cases, values["residual_deflection"])
    for name, (quantities, bit) in GROWING.items():
        first = first_without_growth(strikes, [values[quantity] for quantity in quantities])
        answers[name] = np.where(lost, np.nan, first)
        growing |= np.where(np.isnan(first) & ~lost, bit, 0)
    return answers | {flags: columns[flags] | growing for flags in ("status", "remarks")}


def _at_touch(cases: Array, deflection: Array) -> Array:
    """Return deflections that compare: of a beam that moves on, the last one alone is at rest.

    It is taken as that at the touch before. deflection: (R, strikes).
    """
    values = deflection.copy()
    rows = np.flatnonzero((cases["strikes"] > 1) & (cases["strike_interval"] > 0.0))
    last = cases["strikes"][rows] - 1
    values[rows, last] = values[rows, last - 1]
    return values


def first_without_growth(strikes: Array, series: Iterable[Array]) -> Array:
    """Return the strike of each run from which on nothing grows, NaN for none.

    strikes: of each run. series: of what may grow, (R, strikes) each.
    """
    last = np.zeros(strikes.size)  # the last strike in which something grows
    for values in series:
        numbers = np.arange(1, values.shape[1] + 1)
        growth = np.abs(np.diff(values, axis=1, prepend=0.0))
        grows = ~(growth <= NO_GROWTH * np.abs(values) + _ROUND_OFF)  # NaN: may grow
        grows &= numbers <= strikes[:, np.newaxis]
        last = np.maximum(last, np.where(grows, numbers, 0).max(axis=1))
    return np.where(last < strikes, last + 1.0, np.nan)
