"""The cheapest discretisation that is fine enough, from pilot runs on the study's corner cases.

The uncertainties of the three axes are found separately and added: that of the nodes (at the
study's courant, so that the time step shrinks with the spacing), that of the points and that of the
time step (both at the fewest nodes that suffice by themselves).
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from impactlab.model.discretisation import Discretisation
from impactlab.model.parameters import with_values
from impactlab.solver.jit import SOURCES_HASH
from impactlab.study.adaptive.levels import (
    AXES,
    Levels,
    cheapest,
    grid_options,
    refinement_levels,
    relative,
    uncertainty,
)
from impactlab.study.adaptive.pilot_runs import PilotRuns, corner_cases
from impactlab.study.engine import Engine
from impactlab.study.errors import Problem, StudyError
from impactlab.study.schema.model import Auto
from impactlab.study.schema.study import Study
from impactlab.study.store import locked
from impactlab.variables import provenance


def recommend(study: Study, folder: Path, engine: Engine, wishes: Auto | None = None) -> xr.Dataset:
    """Return the recommended discretisation and its evidence, from pilot runs on corner cases.

    folder: for the shards of the pilot runs. wishes: tolerance, and the responses that have to meet
    it; by default the study's own, or else 1 % for all.

    For each axis (nodes, points, courant), <axis>_value and <axis>_uncertainty are on (response,
    case, axis) in the unit of the response, infinite where unknown. All combinations of levels are
    as `levels.grid_options` returns them. `asked` (response) is True for requested responses;
    `recommended` is the cheapest candidate that meets the tolerance for every requested response
    for which any candidate does, -1 where there is none. check_difference (response, case) lies
    between the recommended candidate and the last level of all axes at once: an independent check
    of the sum. grid_uncertainty (response, case) and grid_relative (response) belong to the study's
    grid, the recommended one where it is to be found; attributes grid_nodes, grid_points and
    grid_courant name it. Raises OSError when the disk is full, no scheduler answers, or another
    process works in `folder`.
    """
    wishes = wishes or study.auto or Auto()
    impact, grid = with_values(study.impact, study.discretisation, study.sampling.fixed)
    study = replace(study, impact=impact, discretisation=grid)
    cases = corner_cases(study)
    pilots = PilotRuns(study, cases, folder, engine)
    levels, responses = refinement_levels(grid), wishes.responses or study.responses
    with locked(folder):  # over all pilot runs
        found = _evidence(study, pilots, levels, wishes.tolerance, responses)
    labels = {name: ("case", np.array(values)) for name, values in cases.items()}
    attrs: dict[str, Any] = {
        "study": study.name,
        "study_sha256": study.sha256,
        "kernels_sha256": SOURCES_HASH,
        "tolerance": wishes.tolerance,
    }
    chosen = recommended_grid(found, grid) if study.auto else grid
    found = found.assign(_grid_uncertainty(found, chosen))
    attrs |= {f"grid_{axis}": getattr(chosen, axis) for axis in AXES if chosen}
    return found.assign_coords(labels).assign_attrs(attrs | provenance())


def recommended_grid(found: xr.Dataset, base: Discretisation) -> Discretisation | None:
    """Return the base with nodes, points and courant of the recommended candidate, or None."""
    at = int(found["recommended"])
    if at < 0:
        return None
    nodes, points, courant = (found[f"candidate_{axis}"].values[at].item() for axis in AXES)
    return replace(base, nodes=int(nodes), points=int(points), courant=courant)


def _grid_uncertainty(found: xr.Dataset, grid: Discretisation | None) -> dict[str, xr.DataArray]:
    """Return the numerical uncertainty of a grid on the levels; nothing without a grid."""
    if grid is None:
        return {}
    parts = [
        found[f"{axis}_uncertainty"].sel({axis: getattr(grid, axis)}, drop=True) for axis in AXES
    ]
    amount = parts[0] + parts[1] + parts[2]
    last = found["nodes_value"].isel(nodes=-1, drop=True)
    return {"grid_uncertainty": amount, "grid_relative": relative(amount, last).max("case")}


def _evidence(
    study: Study, pilots: PilotRuns, levels: Levels, tolerance: float, responses: Collection[str]
) -> xr.Dataset:
    own = study.discretisation
    found = xr.Dataset(_axis(pilots, "nodes", levels.nodes, own))
    asked = found["response"].isin(list(responses))
    middle = replace(own, nodes=_fewest_nodes(found, asked, tolerance))
    found = found.assign(_axis(pilots, "points", levels.points, middle))
    found = found.assign(_axis(pilots, "courant", levels.courant, middle)).assign(asked=asked)
    found = found.assign(grid_options(found, study, tolerance))
    found = found.assign(recommended=cheapest(found, tolerance))
    return found.assign(check_difference=_check(found, pilots, levels, own))


def _axis(
    pilots: PilotRuns, axis: str, levels: tuple[float, ...], at: Discretisation
) -> dict[str, xr.DataArray]:
    values, without_limit = pilots.along(axis, levels, at)
    amounts = uncertainty(values, axis).where(~without_limit, np.inf)
    return {f"{axis}_value": values, f"{axis}_uncertainty": amounts}


def _fewest_nodes(found: xr.Dataset, asked: xr.DataArray, tolerance: float) -> int:
    """Return the fewest nodes that suffice for all requested responses for which any do."""
    worst = relative(found["nodes_uncertainty"], found["nodes_value"].isel(nodes=-1)).max("case")
    meets = worst <= tolerance
    enough = (meets | ~meets.any("nodes") | ~asked).all("response")
    return int(found["nodes"].values[np.argmax(enough.values)])


def _check(
    found: xr.Dataset, pilots: PilotRuns, levels: Levels, own: Discretisation
) -> xr.DataArray:
    """Return the distance from the recommended candidate to the last levels, or NaN without one."""
    chosen = recommended_grid(found, own)
    last = replace(own, points=levels.points[-1], courant=levels.courant[-1])
    if chosen is None:
        return xr.full_like(found["nodes_value"].isel(nodes=0, drop=True), np.nan)
    ours = pilots.along("nodes", (chosen.nodes,), chosen).values
    theirs = pilots.along("nodes", levels.nodes[-1:], last).values
    return abs(ours.isel(nodes=0, drop=True) - theirs.isel(nodes=0, drop=True))


def fits(found: xr.Dataset, study: Study) -> bool:
    """Return True if a recommendation was made for this very study, by these kernels."""
    same = found.attrs.get("study_sha256") == study.sha256
    return same and found.attrs.get("kernels_sha256") == SOURCES_HASH


def apply_recommendation(study: Study, found: xr.Dataset) -> Study:
    """Return the study with its recommended discretisation (see `recommend`).

    Raises StudyError where no discretisation meets the tolerance for a requested response, naming
    the nearest; ValueError where the study's discretisation is not `auto`.
    """
    auto = study.auto
    if auto is None:
        raise ValueError(f"{study.path}: its discretisation is given, so there is none to find")
    if missed := _unreached(found):
        most, listed = int(found["nodes"].max()), ", ".join(missed)
        reason = (
            f"no discretisation up to {most} nodes meets {100 * auto.tolerance:g} % for {listed}: "
            "raise tolerance, or list other responses under discretisation.auto.responses"
        )
        raise StudyError(Problem(str(study.path), "discretisation.auto", reason))
    grid = recommended_grid(found, study.discretisation)
    assert grid is not None  # some response is requested, and all are reached
    return replace(study, discretisation=grid, auto=None)


def _unreached(found: xr.Dataset) -> list[str]:
    """Return the requested responses that no candidate resolves, with the least uncertainty."""
    missed = found["response"].values[(found["asked"] & ~found["reached"]).values]
    least = found["candidate_uncertainty"].min("candidate")
    return [f"{name} ({_percent(least.sel(response=name).item())})" for name in missed]


def _percent(share: float) -> str:
    return f"{100 * share:.2g} % at best" if np.isfinite(share) else "nothing bounds its error"
