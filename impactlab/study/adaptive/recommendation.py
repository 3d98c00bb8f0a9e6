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
    Ladders,
    candidates,
    cheapest,
    ladders,
    relative,
    uncertainty,
)
from impactlab.study.adaptive.pilot_runs import Trials, corner_cases
from impactlab.study.engine import Engine
from impactlab.study.errors import Problem, StudyError
from impactlab.study.schema.model import Auto
from impactlab.study.schema.study import Study
from impactlab.study.store import locked
from impactlab.variables import provenance


def recommend(study: Study, folder: Path, engine: Engine, wishes: Auto | None = None) -> xr.Dataset:
    """Try discretisations on the corner cases: which is fine enough for these responses?

    folder: for the shards of the trials. wishes: tolerance, and the responses that it is asked
    of; without it the study's own, or else 1 % of all.

    Returns, for each axis (nodes, points, courant), <axis>_value and <axis>_uncertainty on
    (response, case, axis) in the unit of the response, infinite where nothing can be said; what
    adaptive.candidates tells of every combination of rungs; `asked` (response); `recommended`, the
    cheapest candidate that meets the tolerance for every asked response that any candidate meets
    it for, -1 where there is none; check_difference (response, case), from the recommended
    candidate to the last rung of all axes at once, an independent check of the sum.
    grid_uncertainty (response, case) and grid_relative (response) are of the study's grid, the
    recommended one where its own is to be found; attributes grid_nodes, grid_points and
    grid_courant name it. Raises OSError when the disk is full, no scheduler answers, or another
    process works in `folder`.
    """
    wishes = wishes or study.auto or Auto()
    impact, grid = with_values(study.impact, study.discretisation, study.sampling.fixed)
    study = replace(study, impact=impact, discretisation=grid)
    cases = corner_cases(study)
    trials = Trials(study, cases, folder, engine)
    asked = wishes.responses or study.responses
    with locked(folder):  # over all trials
        found = _tried(study, trials, ladders(study.discretisation), wishes.tolerance, asked)
    labels = {name: ("case", np.array(values)) for name, values in cases.items()}
    attrs: dict[str, Any] = {
        "study": study.name,
        "study_sha256": study.sha256,
        "kernels_sha256": SOURCES_HASH,
        "tolerance": wishes.tolerance,
    }
    chosen = recommended(found, grid) if study.auto else grid
    found = found.assign(_of_the_study(found, chosen))
    attrs |= {f"grid_{axis}": getattr(chosen, axis) for axis in AXES if chosen}
    return found.assign_coords(labels).assign_attrs(attrs | provenance())


def recommended(found: xr.Dataset, base: Discretisation) -> Discretisation | None:
    """The base with nodes, points and courant of the recommended candidate; None: there is none."""
    at = int(found["recommended"])
    if at < 0:
        return None
    nodes, points, courant = (found[f"candidate_{axis}"].values[at].item() for axis in AXES)
    return replace(base, nodes=int(nodes), points=int(points), courant=courant)


def _of_the_study(found: xr.Dataset, grid: Discretisation | None) -> dict[str, xr.DataArray]:
    """The numerical uncertainty of a grid on the ladders; nothing where there is no grid."""
    if grid is None:
        return {}
    parts = [
        found[f"{axis}_uncertainty"].sel({axis: getattr(grid, axis)}, drop=True) for axis in AXES
    ]
    amount = parts[0] + parts[1] + parts[2]
    last = found["nodes_value"].isel(nodes=-1, drop=True)
    return {"grid_uncertainty": amount, "grid_relative": relative(amount, last).max("case")}


def _tried(
    study: Study, trials: Trials, rungs: Ladders, tolerance: float, responses: Collection[str]
) -> xr.Dataset:
    own = study.discretisation
    found = xr.Dataset(_axis(trials, "nodes", rungs.nodes, own))
    asked = found["response"].isin(list(responses))
    middle = replace(own, nodes=_enough(found, asked, tolerance))
    found = found.assign(_axis(trials, "points", rungs.points, middle))
    found = found.assign(_axis(trials, "courant", rungs.courant, middle)).assign(asked=asked)
    found = found.assign(candidates(found, study, tolerance))
    found = found.assign(recommended=cheapest(found, tolerance))
    return found.assign(check_difference=_check(found, trials, rungs, own))


def _axis(
    trials: Trials, axis: str, rungs: tuple[float, ...], at: Discretisation
) -> dict[str, xr.DataArray]:
    values, without_limit = trials.along(axis, rungs, at)
    amounts = uncertainty(values, axis).where(~without_limit, np.inf)
    return {f"{axis}_value": values, f"{axis}_uncertainty": amounts}


def _enough(found: xr.Dataset, asked: xr.DataArray, tolerance: float) -> int:
    """The fewest nodes that do for all asked responses that any number of nodes does for."""
    worst = relative(found["nodes_uncertainty"], found["nodes_value"].isel(nodes=-1)).max("case")
    meets = worst <= tolerance
    enough = (meets | ~meets.any("nodes") | ~asked).all("response")
    return int(found["nodes"].values[np.argmax(enough.values)])


def _check(found: xr.Dataset, trials: Trials, rungs: Ladders, own: Discretisation) -> xr.DataArray:
    """How far the recommended candidate lies from the last rungs, NaN where there is none."""
    chosen = recommended(found, own)
    last = replace(own, points=rungs.points[-1], courant=rungs.courant[-1])
    if chosen is None:
        return xr.full_like(found["nodes_value"].isel(nodes=0, drop=True), np.nan)
    ours = trials.along("nodes", (chosen.nodes,), chosen).values
    theirs = trials.along("nodes", rungs.nodes[-1:], last).values
    return abs(ours.isel(nodes=0, drop=True) - theirs.isel(nodes=0, drop=True))


def fits(found: xr.Dataset, study: Study) -> bool:
    """Whether trials were made for this very study, by these kernels."""
    same = found.attrs.get("study_sha256") == study.sha256
    return same and found.attrs.get("kernels_sha256") == SOURCES_HASH


def resolved(study: Study, found: xr.Dataset) -> Study:
    """The study with the discretisation that its trials recommend (see `recommend`).

    Raises StudyError where no discretisation meets the tolerance for an asked response, naming
    what comes nearest; ValueError where the study asks for none.
    """
    auto = study.auto
    if auto is None:
        raise ValueError(f"{study.path}: its discretisation is stated: there is none to find")
    if missed := _unreached(found):
        most, told = int(found["nodes"].max()), ", ".join(missed)
        reason = (
            f"no discretisation up to {most} nodes meets {100 * auto.tolerance:g} % for {told}: "
            "raise tolerance, or list other responses under discretisation.auto.responses"
        )
        raise StudyError(Problem(str(study.path), "discretisation.auto", reason))
    grid = recommended(found, study.discretisation)
    assert grid is not None  # something is asked, and all of it is reached
    return replace(study, discretisation=grid, auto=None)


def _unreached(found: xr.Dataset) -> list[str]:
    """The asked responses that no candidate is good enough for, with the least uncertainty."""
    missed = found["response"].values[(found["asked"] & ~found["reached"]).values]
    least = found["candidate_uncertainty"].min("candidate")
    return [f"{name} ({_percent(least.sel(response=name).item())})" for name in missed]


def _percent(share: float) -> str:
    return f"{100 * share:.2g} % at best" if np.isfinite(share) else "nothing bounds its error"
