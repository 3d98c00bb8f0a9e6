"""Notes on the physics, each shown where it matters: a new one is a line in NOTES."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from impactlab.solver.contact import LAWS
from impactlab.solver.contact.about import ABOUT


class Note(NamedTuple):
    """A text, and whether it matters for the runs."""

    applies: Callable[[xr.Dataset], bool]
    text: str


def notes(runs: xr.Dataset) -> list[str]:
    """The texts that matter for these runs, in the order of the table."""
    return [note.text for note in NOTES if note.applies(runs)]


def _holds(runs: xr.Dataset, name: str, value: Any) -> bool:
    """Whether a parameter has this value in some run."""
    return name in runs.coords and value in np.ravel(runs[name].values).tolist()


def _few_lobatto_points(runs: xr.Dataset) -> bool:
    few = _holds(runs, "points", 2) or _holds(runs, "points", 3)
    return few and _holds(runs, "rule", "lobatto")


def _about_the_end(runs: xr.Dataset) -> bool:
    return any(name in runs for name in _AT_THE_END)


def _about(law: str) -> str:
    """What a contact law does that it should not, and what of it is in doubt."""
    about = ABOUT[law]
    parts = [f"Contact law “{law}” ({about.title}).", about.flaws]
    if "energy" in about.flaws:
        parts.append("This is the law, not the solver; the energy balance accounts for it.")
    if about.unconfirmed:
        parts.append(f"Not confirmed: {about.unconfirmed}.")
    return " ".join(filter(None, parts))


_AT_THE_END = ("rebound_velocity", "restitution", "impulse", "permanent_indentation")
NOTES = (
    Note(
        lambda runs: "contact_duration" in runs,
        "One impact holds several sub-impacts: contact ends and begins again. The contact duration "
        "is that of the first contact; the total contact time adds up all contacts within the "
        "simulated time.",
    ),
    Note(
        _about_the_end,
        "Rebound velocity, restitution, impulse and permanent indentation hold for the last "
        "contact within the simulated time: a contact after its end is not in them.",
    ),
    *(
        Note(lambda runs, law=law: _holds(runs, "contact", law), _about(law))  # type: ignore[misc]
        for law in LAWS
        if ABOUT[law].flaws or ABOUT[law].unconfirmed
    ),
    Note(
        lambda runs: "peak_plastic_strain" in runs,
        "In a perfectly plastic section the peak plastic strain (PEEQ) at mid-span does not "
        "converge as the nodes get closer: with 3 Lobatto points it doubles with each halving of "
        "the spacing, with 5 it still grows, and from 9 on it grows slowly.",
    ),
    Note(
        lambda runs: _holds(runs, "scheme", "semi_implicit"),
        "The semi-implicit scheme takes time steps of half a bar wave's time over a spacing: with "
        "many nodes longer than leapfrog's, with few shorter. It tends to the same answers, with "
        "errors about as large at the same nodes. What does not converge, the peak plastic "
        "strain of a perfectly plastic beam, is not to be compared between the two schemes.",
    ),
    Note(
        _few_lobatto_points,
        "Few Lobatto points change the beam itself: 2 make it 3 times too stiff, and 3 put its "
        "full plastic moment at the yield moment.",
    ),
)
"""Every note there is, after the model's own limits."""
