"""The comparison of an impact's beam models with the 3-D finite-element model, from Python."""

from __future__ import annotations

from os import cpu_count

import xarray as xr

from impactlab.fem3d.comparison import compared, simulate_beams
from impactlab.fem3d.plan import Case, planned
from impactlab.fem3d.solver import solve_on
from impactlab.model.checks import instance
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.model.quantities import Quantity, in_si

_CORES = cpu_count() or 1
_LONGEST = 5e-3  # simulated time in s within which the first contact has to end


def witness(
    impact: Impact,
    discretisation: Discretisation | None = None,
    *,
    element_size: Quantity = None,
    patch: Quantity = None,
    duration: Quantity = None,
    workers: int = _CORES,
    force: bool = False,
) -> xr.Dataset:
    """Compare the beam models with 3-D finite elements on one impact.

    Nothing is kept: the command `impactlab witness` keeps fields, figures and a report.

    Parameters
    ----------
    impact : Impact
        Sphere, beam and velocity; its model of the beam plays no part.
    discretisation : Discretisation, optional
        Nodes and points of the beam models; by default `Discretisation()`.
    element_size : Quantity, optional
        Size of the elements about the contact, in m; by default one that takes at most two minutes
        of one core.
    patch : Quantity, optional
        Half the side of the square in which the bodies may touch, in m; by default an estimate.
    duration : Quantity, optional
        Simulated time, in s; by default 2.25 times the first contact of the Euler-Bernoulli beam.
    workers : int, optional
        Number of threads; by default that of the machine's cores.
    force : bool, default False
        True to run even if it takes more than an hour, or more memory than there is.

    Returns
    -------
    xarray.Dataset
        `value` in SI units, and `difference` relative to the 3-D model, on (response, model);
        `status` on model says why a value is NaN. Responses that are not the same quantity in 3-D
        have no difference. The attribute `element_size` (m) tells the elements.

    Raises
    ------
    ValueError
        If a value is not valid, the 3-D model has no such beam, a limit is exceeded, or the 3-D run
        stops before its end.

    Examples
    --------
    >>> models = il.witness(il.paper_impact("1 m/s"), element_size="4 mm", duration="0.3 ms")
    >>> models.model.values.tolist()
    ['solid', 'euler_bernoulli', 'timoshenko', 'spring_mass']
    >>> f"{models.difference.sel(response='peak_force', model='timoshenko'):+.0%}"
    '-...%'
    """
    instance("witness", "impact", impact, Impact)
    lengths = {"element_size": (element_size, "m"), "patch": (patch, "m")}
    wishes = lengths | {"duration": (duration, "s")}
    numbers = {name: in_si(f"witness.{name}", *wish) for name, wish in wishes.items()}
    grid = discretisation or Discretisation()
    plan = planned(Case("witness", "witness", impact, grid, _LONGEST, {}), **numbers)
    if (problem := plan.problem(workers)) and not force:
        raise ValueError(problem)
    solid = solve_on(plan.solved_mesh(), impact, duration=plan.duration, threads=workers)
    if stopped := str(solid.attrs.get("stopped", "")):
        if stopped.startswith("interrupted"):
            raise KeyboardInterrupt(stopped)
        raise ValueError(f"witness: the 3-D run stopped: {stopped}")
    models = compared(solid, simulate_beams(impact, grid, plan.duration))
    return models.assign_attrs(element_size=plan.element_size, duration=plan.duration)
