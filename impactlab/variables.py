"""The table of every variable in impactlab's datasets, and their encoding."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from impactlab import wings
from impactlab.law_texts import describe_laws
from impactlab.model.parameters import PARAMETERS
from impactlab.solver import outputs
from impactlab.solver.outputs import GROWING, NO_GROWTH
from impactlab.solver.outputs import SHORT_PAUSE as SHORT_PAUSE

if TYPE_CHECKING:
    import xarray as xr

STILL_GROWING = outputs.NOT_STEADY | outputs.NO_SHAKEDOWN
"""Bits that status has of the responses that a study lists, and `remarks` else."""
_STOPPED = 256  # beside the kernels' bits: the 3-D model alone has it
FAILURES: dict[str, tuple[int, str]] = {
    "diverged": (outputs.DIVERGED, "the run diverged; every response is missing"),
    "first_contact_unfinished": (
        outputs.FIRST_CONTACT_UNFINISHED,
        "the duration ends before the first contact does",
    ),
    "in_contact_at_end": (
        outputs.IN_CONTACT_AT_END,
        "the duration ends while sphere and beam are in contact",
    ),
    "sphere_not_leaving": (
        outputs.SPHERE_NOT_LEAVING,
        "the duration ends before the sphere moves upwards and away from the beam",
    ),
    "deflection_still_growing": (
        outputs.DEFLECTION_STILL_GROWING,
        "the largest deflection falls on the end of the duration",
    ),
    "indentation_still_growing": (
        outputs.INDENTATION_STILL_GROWING,
        "the largest indentation falls on the end of the duration",
    ),
    "energy_out_of_balance": (
        outputs.ENERGY_OUT_OF_BALANCE,
        "energy is out of balance by more than 5 %: take more nodes or a smaller courant",
    ),
    "earlier_strike_unfinished": (
        outputs.EARLIER_STRIKE_UNFINISHED,
        "in an earlier strike than the last, the duration ends before the sphere moves upwards and "
        "away from the beam; every response is missing",
    ),
    "stopped": (
        _STOPPED,
        "the 3-D model stopped before its time, or had no room for its contact (see the log); "
        "every response is missing",
    ),
    "no_shakedown": (
        outputs.NO_SHAKEDOWN,
        "the last strike still makes dent or dissipation grow, or its sphere does not leave",
    ),
    "not_steady": (
        outputs.NOT_STEADY,
        "the last strike still makes dent or deflection grow, or its sphere does not leave",
    ),
}
"""Reasons for a missing response, by name: (bit in `status`, in words)."""
MARKS: dict[str, tuple[int, str]] = {
    "outside_contact_law": (
        outputs.OUTSIDE_CONTACT_LAW,
        "the largest indentation is beyond the range of the contact law: it is extrapolated",
    )
}
"""Further flags of `status`, by name: bits that leave every response as it is."""
_WHOLE_RUN = "diverged energy_out_of_balance earlier_strike_unfinished stopped"
STATUS_FLAGS = FAILURES | MARKS
"""All flags of `status`."""
FAILED = sum(bit for bit, _ in FAILURES.values())
"""The bits of a run that failed."""
MARKED = sum(bit for bit, _ in MARKS.values())
"""The bits of a run whose responses are doubtful."""

WARNINGS: dict[str, tuple[int, str]] = {
    "contact_created_energy": (
        outputs.CONTACT_CREATED_ENERGY,
        "the contact law created energy: the contact dissipation is below zero",
    ),
    "contact_left_a_bulge": (
        outputs.CONTACT_LEFT_A_BULGE,
        "the contact law left a bulge: the permanent indentation is below zero",
    ),
    "yield_ratio_outside_data": (
        outputs.YIELD_RATIO_OUTSIDE_DATA,
        "E*/S_y is outside 60 to 1500, the data of the contact law",
    ),
    "poissons_ratio_outside_data": (
        outputs.POISSONS_RATIO_OUTSIDE_DATA,
        "the beam's Poisson's ratio is outside 0.05 to 0.45, the data of the contact law",
    ),
    "hardening_outside_data": (
        outputs.HARDENING_OUTSIDE_DATA,
        "the beam's hardening modulus is above 0.05 of its Young's modulus, beyond the law's data, "
        "or kinematic hardening lets the unloading contact yield in reverse farther than there, or "
        "the beam hardens under the contact beyond twice the sphere's yield stress, or, more than "
        "0.024 of its radius deep or where it yields in reverse, beyond the sphere's yield stress",
    ),
    "sphere_yield_outside_data": (
        outputs.SPHERE_YIELD_OUTSIDE_DATA,
        "the sphere's yield stress is below 1 times the beam's: not compared with 3-D",
    ),
    "stiffness_ratio_outside_data": (
        outputs.STIFFNESS_RATIO_OUTSIDE_DATA,
        "the sphere's Young's modulus is outside 0.33 to 10 times the beam's, the law's data",
    ),
    "contact_circle_outside_data": (
        outputs.CONTACT_CIRCLE_OUTSIDE_DATA,
        "the contact radius is above 0.62 of half the beam's depth or 0.42 of half its width: "
        "forces and indentations may be off by 10 %, and by 30 % where it is nearly the depth",
    ),
    "contact_force_outside_data": (
        outputs.CONTACT_FORCE_OUTSIDE_DATA,
        "the force is above 0.5 of S_y B H of this deep beam (H > B/2): it may be 5 % too large",
    ),
    "shallow_dent": (
        outputs.SHALLOW_DENT,
        "the dent is below 0.06 of the indentation and may be off by 14 %",
    ),
    "struck_near_end": (
        outputs.STRUCK_NEAR_END,
        "the strike lies within a beam depth of an end, where the body is no half-space nor beam",
    ),
    "wall_may_dent": (
        outputs.WALL_MAY_DENT,
        "the section has (or may have) a wall or a flange that dents and bends under the sphere, "
        "which the beam model does not: forces are too large and contacts too short",
    ),
    "round_top": (
        outputs.ROUND_TOP,
        "the beam is round where the sphere strikes, the law's top flat: contacts are too stiff",
    ),
    "stretching_left_out": (
        outputs.STRETCHING_LEFT_OUT,
        "both ends hold the axis, and stretching, which this model leaves out, takes more than 2 % "
        "off the largest deflection by an estimate right within a factor of three: beam_model: "
        "von_karman has it, and rollers have none",
    ),
    "no_shakedown": (
        outputs.NO_SHAKEDOWN,
        f"{FAILURES['no_shakedown'][1]}: `shakedown_strike` is missing",
    ),
    "not_steady": (
        outputs.NOT_STEADY,
        f"{FAILURES['not_steady'][1]}: `steady_strike` is missing",
    ),
    "second_rest": (
        outputs.SECOND_REST,
        "with its plastic strains held, the beam has a second stable shape at rest, bowed the "
        "other way: it is put to rest in that of least energy, and a swing through is not followed",
    ),
    "unstable_rest": (
        outputs.UNSTABLE_REST,
        "plastic strains compress the resting beam so much that on this foundation it would buckle "
        "antisymmetrically: its symmetric shape at rest is not stable",
    ),
    "skin_may_give": (
        outputs.SKIN_MAY_GIVE,
        "the contact radius is above a fifth of the outer layer's thickness, and the contact law "
        "is that of its metal alone: a softer layer beneath makes contacts longer",
    ),
}
"""Warnings on available responses, by name: (bit in `remarks`, in words)."""
OUTSIDE_DATA = sum(bit for name, (bit, _) in WARNINGS.items() if name.endswith("outside_data"))
"""The bits of runs with an input outside the data of the contact law or of the corrections."""

FLAGS: dict[str, tuple[str, dict[str, tuple[int, str]]]] = {
    "status": ("why responses are missing or doubtful (0: none is)", STATUS_FLAGS),
    "remarks": ("warnings on available responses (0: none)", WARNINGS),
}
"""The variables made of bits: (long_name, flags)."""


@dataclass(frozen=True)
class Variable:
    """One dataset variable: where it lives, its unit (UDUNITS) and its meaning.

    missing: the status flag that explains why a response is NaN (besides those of the whole run).
    comment: a caveat for readers of the number.
    """

    name: str
    dims: tuple[str, ...]
    units: str
    long_name: str
    missing: str | None = None
    comment: str | None = None


RESPONSES: dict[str, Variable] = {
    entry.name: Variable(entry.name, (), entry.units, entry.long_name, entry.missing, entry.comment)
    for entry in outputs.RESPONSES
}
"""The scalar answers of a run, by name."""


def _table(*entries: Variable) -> dict[str, Variable]:
    return {entry.name: entry for entry in entries}


HISTORIES = _table(
    Variable("contact_force", ("time",), "N", "contact force"),
    Variable("midspan_deflection", ("time",), "m", "deflection of the beam under the sphere"),
    Variable(
        "midspan_curvature",
        ("time",),
        "m-1",
        "curvature of the beam under the sphere (w_xx; psi_x of a Timoshenko beam)",
    ),
    Variable("sphere_displacement", ("time",), "m", "displacement of the sphere since first touch"),
    Variable("indentation", ("time",), "m", "indentation (approach of sphere and beam axis)"),
)
"""Answers on `time`, by name."""
PROFILES = _table(
    Variable("equivalent_plastic_strain", ("x", "z"), "1", "equivalent plastic strain (PEEQ)"),
    Variable("plastic_strain", ("x", "z"), "1", "plastic strain along the beam"),
    Variable("deflection", ("x",), "m", "deflection at the end of the duration"),
)
"""Answers along the beam at the end of the run, by name."""
FIELDS = _table(
    *(
        Variable(f"{name}_over_time", ("field_time", *entry.dims), entry.units, long_name)
        for (name, entry), long_name in zip(
            PROFILES.items(),
            ("equivalent plastic strain (PEEQ)", "plastic strain along the beam", "deflection"),
            strict=True,
        )
    )
)
"""The same at times in between, by name."""
_SERIES = (
    ("m", "indentation left after all strikes so far"),
    ("m", "deflection under the sphere of the beam at rest after the strike, or at the next one"),
    ("N", "largest contact force of the strike"),
    ("1", "coefficient of restitution of the strike"),
    ("m s-1", "sphere's velocity away from the beam when the strike's last contact ends"),
    ("J", "energy dissipated in the contact in all strikes so far"),
    ("J", "energy dissipated in the fibres in all strikes so far"),
)
BY_STRIKE = _table(
    *(
        Variable(f"{name}_over_strikes", ("strike",), units, long_name)
        for name, (units, long_name) in zip(outputs.SERIES, _SERIES, strict=True)
    )
)
"""Answers of every strike, of runs with several, by name; NaN beyond a run's last one."""
_OF_EACH = "peak_force contact_duration number_of_contacts impulse permanent_indentation"
BY_SPHERE = _table(
    *(
        Variable(f"{name}_of_spheres", ("sphere",), entry.units, f"{entry.long_name}, by sphere")
        for name in (*_OF_EACH.split(), "rebound_velocity")
        for entry in (RESPONSES[name],)
    ),
    Variable("contact_force_of_spheres", ("sphere", "time"), "N", "contact force, by sphere"),
    Variable("status_of_spheres", ("sphere",), "1", "why responses are missing, by sphere"),
)
"""Answers of every sphere, of runs with several, by name."""
_WITHOUT_GROWTH = _table(
    *(
        Variable(
            name,
            (),
            "1",
            f"strike from which on {what} do not grow",
            missing,
            f"from it on, either changes by at most {NO_GROWTH:.1%} of itself per strike; "
            "NaN: the last strike still changes it by more, as `remarks` says (`status`, where the "
            "study lists it among its responses), or the run failed",
        )
        for name, what, missing in zip(
            GROWING,
            ("dent and residual deflection", "dent and dissipation in the fibres"),
            ("not_steady", "no_shakedown"),
            strict=True,
        )
    )
)
SCALARS = RESPONSES | _WITHOUT_GROWTH
"""The responses that a study may list, by name: those of every run, and of several strikes."""
OF_STRIKES = _WITHOUT_GROWTH | BY_STRIKE
"""Answers of runs with several strikes, by name."""
COORDINATES = _table(
    Variable(
        "strike",
        ("strike",),
        "1",
        "number of the strike",
        comment="beyond the number of strikes of a run, which `strikes` states, and from a strike "
        "on whose sphere does not leave, answers are missing",
    ),
    Variable("sphere", ("sphere",), "1", "number of the sphere"),
    Variable("time", ("time",), "s", "time since first touch"),
    Variable("field_time", ("field_time",), "s", "time of the fields since first touch"),
    Variable("x", ("x",), "m", "distance from the left end"),
    Variable("z", ("z",), "m", "distance below the beam's axis"),
    Variable("duration", (), "s", "simulated time"),
    Variable("run", ("run",), "1", "number of the run"),
)
_OF_WINGS = _table(
    *(
        Variable(name, (), units, long_name, comment=comment)
        for model in wings.models().values()
        for name, units, long_name, comment in model.variables
    )
)
_AXES = HISTORIES | PROFILES | FIELDS | OF_STRIKES | BY_SPHERE | COORDINATES
VARIABLES = RESPONSES | _OF_WINGS | _AXES
"""Every variable but those of bits (FLAGS) and the varied parameters (for these see PARAMETERS)."""


def of_function(data: xr.Dataset | xr.DataArray) -> bool:
    """Return whether a dataset, or a variable of one, is of a function, or a table, of the user.

    Its names mean what their attributes say; they are none of the quantities in these tables.
    """
    return "function" in data.attrs or of_table(data)


def of_table(data: xr.Dataset | xr.DataArray) -> bool:
    """Return whether a dataset holds the rows of a table, which no method has drawn."""
    return data.attrs.get("method") == "table"


def attributes(name: str) -> dict[str, Any]:
    """Return CF attributes of a variable, parameter or flag. Raises KeyError if unknown."""
    if name == "status_of_spheres":
        return {"units": "1"} | attributes("status")
    if name in FLAGS:
        long_name, flags = FLAGS[name]
        return {
            "long_name": long_name,
            "flag_masks": np.array([bit for bit, _ in flags.values()], dtype=np.int32),
            "flag_meanings": " ".join(flags),
        }
    entry = VARIABLES[name] if name in VARIABLES else PARAMETERS[name]
    attrs: dict[str, Any] = {"units": entry.units, "long_name": entry.long_name}
    if isinstance(entry, Variable) and entry.missing:
        attrs["missing_because"] = f"{_WHOLE_RUN} {entry.missing}"
    if isinstance(entry, Variable) and entry.comment:
        attrs["comment"] = entry.comment
    return attrs


def described(dataset: xr.Dataset) -> xr.Dataset:
    """Return the dataset with the table's attributes on every variable that the table knows.

    Those of `contact` are source, range, flaws and doubts, one line per law.
    """
    entries = VARIABLES | PARAMETERS | FLAGS
    for name, variable in dataset.variables.items():
        if name in entries:
            variable.attrs = attributes(str(name)) | variable.attrs
    describe_laws(dataset)
    return dataset


def status_bits(responses: Iterable[str]) -> int:
    """Return the status bits under which these responses are missing.

    Names that the table lacks, such as the output of a test function, add none.
    """
    bits = outputs.DIVERGED | outputs.ENERGY_OUT_OF_BALANCE | _STOPPED
    bits |= outputs.EARLIER_STRIKE_UNFINISHED
    for name in responses:
        if name in SCALARS and (reason := SCALARS[name].missing):
            bits |= STATUS_FLAGS[reason][0]
    return bits


def answer_variables(
    answers: Mapping[str, Any], responses: tuple[str, ...], dims: tuple[str, ...]
) -> dict[str, tuple[tuple[str, ...], Any]]:
    """Return the answers as data variables on `dims` (for one run: none), only these responses.

    answers: arrays of numpy or dask, by name. `status` keeps the bits that matter to these
    responses; `remarks` are of the run as a whole, without what `status` says.
    """
    lead = dims or ("run",)
    bits = (answers["status"] & (status_bits(responses) | MARKED)).astype(np.int32)
    scalars = {name: (lead, answers[name]) for name in responses}
    fields = {
        name: ((*lead, *entry.dims), answers[name])
        for name, entry in (HISTORIES | PROFILES | FIELDS | OF_STRIKES | BY_SPHERE).items()
        if name in answers
    }
    remarks = (answers["remarks"] & ~(bits & STILL_GROWING)).astype(np.int32)
    return scalars | fields | {"status": (lead, bits), "remarks": (lead, remarks)}


def reasons(bits: int, flags: Mapping[str, tuple[int, str]] = FAILURES) -> list[str]:
    """Return the flags set in a status, or in `remarks`, in words; flags: by default failures."""
    return [text for bit, text in flags.values() if bits & bit]
