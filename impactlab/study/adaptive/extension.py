"""More runs for a Sobol sample: doubled until intervals are narrow, or solved again on other grids.

The sample is nested: the runs of N base samples are the first ones of 2 N, so none is wasted.
"""

import logging
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import xarray as xr

from impactlab import wings
from impactlab.methods.runs import in_order, listed
from impactlab.study.design import doubled

log = logging.getLogger(__name__)
MOST, FEWEST, SHARE = 64, 16, 8
"""Base samples that are solved again: at most, at least, and as a share (1/SHARE) of all."""
COARSEST = 25
"""Fewest nodes of a coarser grid that still resembles the beam."""
Step = Callable[[xr.Dataset], xr.Dataset]


def extend_sample(design: xr.Dataset, solve: Step, analyse: Step) -> xr.Dataset:
    """Return the runs of the smallest sample whose intervals are as narrow as requested.

    design: of a Sobol study with `until`. solve: returns the runs of a design; analyse: returns
    first_order_interval, total_order_interval (response, parameter) and sensitivity_verdict
    (response) of runs.

    Attributes of the runs are until_reached (1: the intervals are narrow enough) and until_reason
    (why it stopped, in words). Raises ValueError when this version of impactlab draws other runs
    than the design has.
    """
    limit, most = float(design.attrs["until_interval"]), int(design.attrs["until_runs"])
    names = np.atleast_1d(design.attrs.get("until_responses", design.attrs["responses"]))
    while True:
        runs = solve(design)
        analysis = analyse(runs.assign_attrs(analyses="sensitivity"))
        half_width, reason = largest_interval(analysis, [str(name) for name in names])
        count = runs.sizes["run"]
        if half_width > limit and 2 * count <= most:
            log.info("%d runs: %s: twice as many", count, reason)
            design = doubled(design)
            continue
        if half_width <= limit:
            reason += f", within {limit:g}"
        elif half_width > limit:
            reason += f", above {limit:g}, but twice as many runs are more than {most:,}"
        log.info("%d runs: %s", count, reason)
        return runs.assign_attrs(until_reached=int(half_width <= limit), until_reason=reason)


def largest_interval(analysis: xr.Dataset, responses: Sequence[str]) -> tuple[float, str]:
    """Return the half-width of the widest interval of these responses' indices, and words on it.

    analysis: <index>_interval on (response, parameter), NaN for a response without indices, and
    sensitivity_verdict (response) with the reason. The words name the index and every response
    without indices. The half-width is NaN where no response has any.
    """
    requested = analysis.sel(response=list(responses))
    intervals = requested[["first_order_interval", "total_order_interval"]].to_array("index")
    missing = intervals.isnull().all(["index", "parameter"]).values
    verdicts = requested["sensitivity_verdict"]
    lines = str(verdicts.attrs["flag_descriptions"]).splitlines()
    descriptions = dict(zip(np.atleast_1d(verdicts.attrs["flag_values"]), lines, strict=True))
    without = zip(np.array(responses)[missing], verdicts.values[missing], strict=True)
    left_out = "".join(
        f"{name} has no indices ({descriptions[verdict]}); " for name, verdict in without
    )
    if missing.all():
        return np.nan, f"{left_out}no response has indices that more runs could narrow"
    widths = intervals.isel(response=~missing).fillna(np.inf)
    widest = widths.isel(widths.argmax(["index", "response", "parameter"]))
    index = widest["index"].item().removesuffix("_interval").replace("_", "-")
    of = f"{widest['response'].item()} to {widest['parameter'].item()}, ± {widest.item():.3g}"
    return widest.item(), f"{left_out}the widest interval is that of the {index} index of {of}"


def refine_cases(runs: xr.Dataset, solve: Step, count: int | None = None) -> xr.Dataset:
    """Return the first base samples on the grid of the runs and on others, all else unchanged.

    runs: a Sobol sample of impacts, as in runs.nc. solve: returns the runs of a design, which
    includes the grid of the runs. count: base samples to solve again; None: see `base_samples`.

    The result is on (run, grid), in SI units, with the attributes of a Sobol sample of so many
    base_samples without second order. `grid` is "used"; "finer", with half the spacing (and at the
    same courant a smaller time step); "more_points" over the depth, nearly twice as many; and
    "coarser", with about twice the spacing, where that leaves COARSEST nodes; nodes and points
    (grid) describe each. Raises ValueError where the runs are no such sample, OSError when the disk
    is full or no scheduler answers.
    """
    study, method = runs.attrs.get("study", "?"), runs.attrs.get("method", "none")
    if method != "sobol":
        raise ValueError(
            f"study {study!r}: its runs are of method {method}, but only those of sobol can be "
            "refined"
        )
    if "function" in runs.attrs or wings.among(runs.coords.get("beam_model", "")):
        raise ValueError(f"study {study!r}: its runs are not of a beam model, so they have no grid")
    names = listed(runs, "varied")
    if drawn := [name for name in ("nodes", "points") if name in names]:
        raise ValueError(f"study {study!r}: draws its {drawn[0]}, so there is no grid to refine")
    first = _first(in_order(runs), count).compute()
    nodes, points = int(runs["nodes"]), int(runs["points"])
    grids = {"used": (nodes, points), "finer": (2 * nodes - 1, points)}
    grids["more_points"] = nodes, 2 * points - 1
    coarser = 2 * round((nodes - 1) / 4) + 1  # odd, for a node in the middle
    if coarser >= COARSEST:
        grids["coarser"] = coarser, points
    beside = [name for name, values in first.coords.items() if set(values.dims) - {"run"}]
    design = first.drop_vars([*first.data_vars, *beside, "nodes", "points"]).assign_coords(
        grid=("grid", list(grids), {"long_name": "discretisation"}),
        nodes=("grid", [nodes for nodes, _ in grids.values()]),
        points=("grid", [points for _, points in grids.values()]),
    )
    solved = solve(design.assign_attrs(varied=[*names, "nodes", "points"], histories=0, profiles=0))
    return solved.assign_attrs(varied=names)


def base_samples(total: int) -> int:
    """Return how many base samples are solved again: half-widths fall with their square root."""
    return min(total, max(FEWEST, min(MOST, total // SHARE)))


def _first(runs: xr.Dataset, count: int | None) -> xr.Dataset:
    """Return the runs of the first base samples: at A, at A with one column of B each, and at B."""
    total = int(runs.attrs["base_samples"])
    step, second = runs.sizes["run"] // total, int(runs.attrs["second_order"])
    factors = (step - 2) // (2 if second else 1)
    offsets = [*range(factors + 1), step - 1]  # before the last: B with columns of A
    count = min(total, count or base_samples(total))
    places = np.add.outer(step * np.arange(count), offsets).ravel()
    attrs: dict[str, Any] = {"base_samples": count, "second_order": 0}
    return runs.isel(run=places).assign_attrs(attrs)
