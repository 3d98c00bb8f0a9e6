"""A 3-D run beside the beam models: solved, compared, written to files, drawn and printed.

`witness` is the comparison from Python, which keeps nothing.
"""

from __future__ import annotations

import tempfile
from contextlib import AbstractContextManager
from dataclasses import replace
from functools import partial
from os import cpu_count
from pathlib import Path

import numpy as np
import xarray as xr
from pyevtk.hl import unstructuredGridToVTK
from pyevtk.vtk import VtkHexahedron
from rich import box
from rich.console import Console
from rich.table import Column, Table

from impactlab.fem3d.figures.run import animation, draw_witness
from impactlab.fem3d.plan import Case, RunPlan, beam_models, planned
from impactlab.fem3d.report import write_comparison
from impactlab.fem3d.solver import solve_on
from impactlab.fem3d.solver.march import Progress
from impactlab.fem3d.wing import SOLID, UNLIKE
from impactlab.figures import labels
from impactlab.figures.animation import FILE
from impactlab.figures.labels import display
from impactlab.files import opened, replaced, write_netcdf
from impactlab.model.checks import instance
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.model.quantities import Quantity, in_si
from impactlab.simulate import run_dataset
from impactlab.variables import RESPONSES, attributes, reasons, status_bits

_HEAD = ("response", "units", "model", "value", "difference_percent", "missing_because")


def compare(
    plan: RunPlan,
    folder: Path,
    *,
    workers: int,
    watched: AbstractContextManager[Progress],
    frames: bool = False,
) -> tuple[xr.Dataset, xr.Dataset, Path]:
    """Solve a planned case by the 3-D FE model and the beam models; write and draw the answers.

    folder: gets witness.nc, witness.vtu, beams.nc, comparison.csv, figures/ and report.html. If the
    3-D run stopped before its end, and the folder holds a complete run, FOLDER_stopped gets them.
    workers: number of threads. watched: is entered around the 3-D run, and gives its `progress`.
    frames: whether to animate the section through the contact, too.

    Returns the answers of the 3-D FE model, the responses of all models (see compared), and the
    folder where the files lie. Answers are on disk before anything is made of them. Raises OSError
    where the folder cannot be written to, before anything is solved.
    """
    check_writable(folder)
    try:
        with opened(folder / "witness.nc") as before:
            complete = "stopped" not in before.attrs
    except OSError:
        complete = False
    with watched as progress:
        mesh, impact = plan.solved_mesh(), plan.case.impact
        solid = solve_on(
            mesh, impact, duration=plan.duration, threads=workers, progress=progress, frames=frames
        )
    if "stopped" in solid.attrs and complete:
        folder = folder.parent / f"{folder.resolve().name}_stopped"
    write_netcdf(solid, folder / "witness.nc", "witness")
    write_vtu(solid, folder / "witness.vtu")
    beams = simulate_beams(impact, plan.case.discretisation, float(solid["duration"]))
    write_netcdf(beams, folder / "beams.nc", "beams")
    responses = compared(solid, beams)
    write_csv(responses, folder / "comparison.csv")
    draw_witness(solid, beams, folder / "figures", plan.case.name)
    (folder / "figures" / FILE).unlink(missing_ok=True)
    if frames:
        animation(solid).save(folder / "figures" / FILE)
    write_comparison(responses, solid, plan, folder / "figures", folder / "report.html")
    return solid, responses, folder


def check_writable(folder: Path) -> None:
    """Make the folder if needed. Raises OSError where answers could not be kept."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError as error:
        raise OSError(
            f"--output {folder}: {error.strerror}: nothing was solved; name a folder to write to"
        ) from None


def simulate_beams(impact: Impact, discretisation: Discretisation, duration: float) -> xr.Dataset:
    """Return the answers of `simulate` for all of beam_models, on the dimension `beam_model`.

    All take the leapfrog scheme, the only one that they share. duration: in s.
    """
    grid = replace(discretisation, scheme="leapfrog")
    runs = [
        run_dataset(replace(impact, beam_model=model), grid, duration=duration)
        for model in beam_models(impact)
    ]
    return xr.concat(runs, "beam_model", combine_attrs="override")


def compared(solid: xr.Dataset, beams: xr.Dataset) -> xr.Dataset:
    """Return `value` and `difference` on (response, model), and `status` on (model).

    value: in SI units, as `units` (response) has them; NaN where a model gives none, and `status`
    says why. difference: relative to the 3-D FE model; NaN for responses that are UNLIKE and for
    the number of contacts, of which it tells nothing.
    """
    names = [name for name in RESPONSES if name in solid]
    pair = [runs[[*names, "status"]] for runs in (solid.expand_dims(beam_model=[SOLID]), beams)]
    runs = xr.concat(pair, "beam_model", coords="minimal", compat="override", combine_attrs="drop")
    sound = [runs[name].where((runs["status"] & status_bits([name])) == 0) for name in names]
    value = np.array(sound, dtype=float)
    with np.errstate(divide="ignore", invalid="ignore"):
        difference = value / value[:, :1] - 1.0
    difference[~np.isfinite(difference)] = np.nan
    difference[:, 0] = np.nan
    difference[[name in UNLIKE or name == "number_of_contacts" for name in names]] = np.nan
    return xr.Dataset(
        {
            "value": (("response", "model"), value),
            "difference": (("response", "model"), difference),
            "status": ("model", runs["status"].values.astype(np.int32)),
        },
        coords={
            "response": names,
            "model": runs["beam_model"].values.tolist(),
            "units": ("response", [attributes(name)["units"] for name in names]),
        },
    )


def write_csv(comparison: xr.Dataset, path: Path) -> None:
    """Write one row per response and model, in SI units; all or nothing (see files.replaced)."""
    table = comparison.to_dataframe(["response", "model"]).reset_index()
    why = table["status"].map(lambda status: "; ".join(reasons(status)))
    table["missing_because"] = why.where(table["value"].isna(), "")
    share = 100.0 * table["difference"]
    table["difference_percent"] = share.map("{:.6g}".format, na_action="ignore")
    with replaced(path) as unfinished:
        table.to_csv(
            unfinished, columns=_HEAD, index=False, lineterminator="\n", float_format="%.9g"
        )


def write_vtu(dataset: xr.Dataset, path: Path) -> None:
    """Write a 3-D FE model's mesh with all its fields; all of it or nothing, under the same names.

    dataset: of fem3d.solver. What lies on `element` becomes cell data, what lies on `node` and
    `axis` vectors of the points, in SI units; points are where they were at first touch.
    Raises OSError: see files.replaced.
    """
    elements, count = dataset["element_nodes"].values, dataset.sizes["element"]
    cells, points = {}, {}
    for name, variable in dataset.variables.items():
        values = variable.values
        if variable.dims == ("element",):  # VTK has no booleans
            cells[name] = values.astype(np.int8) if values.dtype == bool else values
        elif variable.dims == ("node", "axis"):
            points[name] = tuple(np.ascontiguousarray(column) for column in values.T)
    place = points.pop("node_position")
    with (
        replaced(path, dataset.nbytes) as unfinished,
        tempfile.TemporaryDirectory(dir=path.parent, prefix=f".{path.name}.") as folder,
    ):
        written = unstructuredGridToVTK(
            f"{folder}/mesh",
            *place,
            connectivity=np.ascontiguousarray(elements.ravel()),
            offsets=8 * np.arange(1, count + 1, dtype=np.int64),
            cell_types=np.full(count, VtkHexahedron.tid, dtype=np.uint8),
            cellData=cells,
            pointData=points,
        )
        Path(written).replace(unfinished)


def print_comparison(comparison: xr.Dataset, solid: xr.Dataset) -> None:
    """Print one row per response: the 3-D value, and each beam model's with its difference in %.

    comparison: see compared. solid: a dataset of fem3d.solver. Below the table, the missing
    responses and the reasons, by model, and where more yields than the responses show: elements
    with one integration point yield as a whole, and late in bending.
    """
    names = comparison["model"].values.tolist()
    models = ["3-D" if name == SOLID else name.replace("_", "-").title() for name in names]
    right = [Column(name, justify="right") for name in models]
    table = Table(  # narrow enough for 80 columns
        Column("response", no_wrap=True), *right, box=box.SIMPLE, show_edge=False, padding=0
    )
    for name in comparison["response"].values.tolist():
        row = comparison.sel(response=name)
        values = row["value"].rename(name).assign_attrs(units=row["units"].item())
        unit = display(values)  # fits the largest value
        cells = map(_cell, unit(values), 100.0 * row["difference"].values)
        table.add_row(f"{name} ({unit.symbol})" if unit.symbol else name, *cells)
    missing: dict[str, list[str]] = {}
    for model, status in zip(models, comparison["status"].values.tolist(), strict=True):
        for reason in reasons(status):
            missing.setdefault(reason, []).append(model)
    console = Console()
    console.print(table)
    console.print("In %: difference from the 3-D FE model.", markup=False)
    for why in dict.fromkeys(UNLIKE.values()):
        which = labels.listing([name for name, cause in UNLIKE.items() if cause == why])
        console.print(f"not compared: {which}: {why}", markup=False)
    for reason, lacking in missing.items():
        who = "all models" if lacking == models else ", ".join(lacking)
        console.print(f"missing ({who}): {reason}", markup=False)
    show = partial(console.print, markup=False, highlight=False)
    if (sphere := float(solid["sphere_plastic_strain"])) > 0.0:
        show(f"the sphere yields, too: PEEQ up to {sphere:.2%}, in plastic_dissipation alone")
    if (coarse := float(solid["one_point_plastic_strain"])) > 1e-3:
        show(
            f"elements with one integration point yield: PEEQ up to {coarse:.2%} away from contact "
            "and middle, where they are too stiff in bending"
        )


def _cell(value: float, share: float) -> str:
    if np.isnan(value):
        return "missing"
    digits = 1 if abs(share) < 9.95 else 0
    return f"{value:.4g}" + ("" if np.isnan(share) else f" {share:+.{digits}f}%")


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
