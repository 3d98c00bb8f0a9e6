"""Further spheres on one beam: their places, velocities and delays, as text and as rows."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from impactlab.model.checks import require
from impactlab.model.quantities import si
from impactlab.solver import WAVE_MODELS
from impactlab.solver.types import SPHERES

_UNITS = {"strike_position": "1", "velocity": "m s-1", "delay": "s"}
EXAMPLE = "[{strike_position: 0.25, velocity: 3 m/s, delay: 0.5 ms}]"
_AS = f"must be a list of spheres, 1 to {SPHERES}, as {EXAMPLE}, or as text '0.25 3 0.0005' in SI"
PLACE_OF_ITS_OWN = "must have a place of its own each: strikes and strike_interval repeat a strike"
"""Why two spheres cannot strike one node."""
PRESTRESSED = (
    "must be ignored with further_spheres, for the kink that dents leave is that of one of them: "
    "change it, or leave them out"
)
"""Why a contact's prestress is that of one sphere."""


def sphere_rows(spheres: Any) -> tuple[tuple[float, ...], ...]:
    """Return rows of place, velocity (m/s) and delay (s) of spheres, which may be text.

    Raises TypeError or ValueError where they are none.
    """
    if isinstance(spheres, str):
        spheres = [[float(word) for word in row.split()] for row in spheres.split(",")]
    rows = []
    for sphere in spheres:
        if not isinstance(sphere, Mapping) and len(sphere) != len(_UNITS):
            raise ValueError(f"a row needs {len(_UNITS)} numbers: {', '.join(_UNITS)}")
        row = {"delay": 0.0} | dict(
            sphere if isinstance(sphere, Mapping) else zip(_UNITS, sphere, strict=True)
        )
        if differing := row.keys() ^ _UNITS.keys():
            raise ValueError(f"other keys: {', '.join(map(str, differing))}")
        rows.append(tuple(si(row[name], units) for name, units in _UNITS.items()))
    return tuple(rows)


def spheres_text(impact: Any) -> str | None:
    """Return the further spheres of an impact as text, whose digits lead back to the numbers.

    Raises ValueError where they are not valid, or another field is at odds with them.
    """
    spheres = impact.further_spheres
    if spheres is None:
        return None
    # a colon ends the value in messages
    shown = spheres if ":" not in repr(spheres) else str(spheres).replace(":", "")
    reason = ""
    try:
        rows = sphere_rows(spheres)
    except (TypeError, ValueError) as error:
        rows, reason = (), f" ({error})"
    field = "Impact", "further_spheres", shown
    require(1 <= len(rows) <= SPHERES, *field, f"{_AS}{reason}")
    for place, velocity, delay in rows:
        require(velocity > 0.0, *field, "must have velocities above zero")
        require(delay >= 0.0, *field, "must have delays of zero or more")
        left, right = (getattr(impact.beam, f"support_{side}") for side in ("left", "right"))
        free = (("free", "elastic"),)
        on_end = (place == 0.0) & np.isin(left, *free) | (place == 1.0) & np.isin(right, *free)
        message = "must have places above 0 and below 1 of the span, or at a free or elastic end"
        require((0.0 < place < 1.0) | on_end, *field, message)
    places = [place for place, _, _ in rows]
    lone = len(set(places)) == len(places) and not np.isin(impact.strike_position, places).any()
    require(lone, *field, PLACE_OF_ITS_OWN)
    end = "with further_spheres: change it, or leave them out"
    needs: tuple[tuple[str, str, Any, Any, str], ...] = (
        ("Impact", "beam_model", impact, WAVE_MODELS, " or ".join(WAVE_MODELS)),
        ("Impact", "load", impact, ("point",), "point"),
        ("Impact", "strikes", impact, (1,), "1"),
    )
    for owner, name, node, holds, needed in needs:
        value = getattr(node, name)
        require(np.isin(value, holds), owner, name, value, f"must be {needed} {end}")
    ignored = np.equal(impact.contact_prestress, "ignored")
    require(ignored, "Impact", "contact_prestress", impact.contact_prestress, PRESTRESSED)
    return ", ".join(" ".join(map(repr, row)) for row in rows)
