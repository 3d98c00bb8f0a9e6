"""Runs with a given number of time steps, which users set by the Courant number alone."""

from __future__ import annotations

from dataclasses import replace

import xarray as xr

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.simulate import case_table, simulate
from impactlab.solver.contact.history import make_pair
from impactlab.solver.leapfrog import discretise
from impactlab.solver.section import make_section


def critical_time_step(impact: Impact, grid: Discretisation) -> float:
    """The scheme's largest time step in s, from the number of steps that a second would take."""
    return 1.0 / _steps(impact, replace(grid, courant=1.0), 1.0)


def node_steps(impact: Impact, grid: Discretisation, duration: float) -> int:
    """What a run costs, but for what a node costs a step: nodes of the half beam, times steps."""
    return grid.nodes // 2 * _steps(impact, grid, duration)


def _steps(impact: Impact, grid: Discretisation, duration: float) -> int:
    case = case_table(impact, grid, duration=duration)[0]
    _, steps = discretise(case, make_pair(case), make_section(case))
    return int(steps)


def simulate_in_steps(
    impact: Impact, grid: Discretisation, *, duration: float, steps: int, samples: int
) -> xr.Dataset:
    """simulate() in that many steps, whatever the grid's Courant number says.

    Raises ValueError where so few steps are unstable.
    """
    # half a step of margin: the kernels round up
    courant = duration / ((steps - 0.5) * critical_time_step(impact, grid))
    return simulate(impact, replace(grid, courant=courant), duration=duration, samples=samples)
