"""Tables of the variables of every dataset that impactlab returns, made from small runs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path
from pkgutil import resolve_name
from tempfile import TemporaryDirectory

import xarray as xr

import impactlab as il
from impactlab.analysis import ANALYSES
from impactlab.methods import SAMPLES
from impactlab.methods.sampling import RandomSample
from impactlab.model.parameters import PARAMETERS
from impactlab.variables import FLAGS

GRID = il.Discretisation(nodes=21, scheme="modal")
SIZES = {"sobol": {"base_samples": 64}, "morris": {"trajectories": 16}, "fast": {"samples": 1200}}
"""Sizes of the samples, by method; of the others, 128 runs."""
STORED = (
    "A grid of nodes, time steps and points with `store: {histories: true}`; a sample has the "
    "one dimension `run`. `store: {profiles: true}` adds the fields on `x` and `z` of `simulate`; "
    "several strikes or spheres add what it has on `strike` and `sphere`, and the strikes from "
    "which on nothing grows."
)
MEANINGS = {name: entry.long_name for name, entry in PARAMETERS.items()} | {
    "asked": "True for a response that has to meet the tolerance",
    "candidate_cost": "cost over that of the study's own discretisation, the cheapest first",
    "candidate_courant": "time step over the scheme's largest",
    "candidate_nodes": "nodes along the span",
    "candidate_points": "integration points over the depth",
    "candidate_uncertainty": "relative numerical uncertainty, the worst over the cases",
    "case": "corner case",
    "check_difference": "recommended candidate less the last level of all axes at once",
    "courant_uncertainty": "numerical uncertainty of the time step, in `response_units`",
    "courant_value": "response by courant, in `response_units`",
    "grid_relative": "relative numerical uncertainty of the study's grid, the worst over the cases",
    "grid_uncertainty": "numerical uncertainty of the study's grid, in `response_units`",
    "history_long_name": "meaning of the history",
    "history_units": "SI unit of the history",
    "measured_conditions": "stated parameters of the impact, JSON, SI",
    "measured_quantity": "measured response",
    "measured_source": "source of the measurement",
    "measured_units": "SI unit of the measurement",
    "model": "contact law; empty where there is one model",
    "nodes_uncertainty": "numerical uncertainty of the nodes, in `response_units`",
    "nodes_value": "response by nodes, in `response_units`",
    "other_parameter": "the other parameter",
    "parameter": "calibrated parameter",
    "parameter_long_name": "meaning of the parameter",
    "parameter_units": "SI unit of the parameter",
    "points_uncertainty": "numerical uncertainty of the points, in `response_units`",
    "points_value": "response by points, in `response_units`",
    "reached": "True where a candidate meets the tolerance",
    "recommended": "number of the cheapest candidate that meets the tolerance; -1: none",
    "response_long_name": "meaning of the response",
    "response_units": "SI unit of the response",
}
"""Meanings of variables that have no attribute `long_name`, by name."""
WRONG = ("asked",)
"""Variables with the long_name of another one."""


def make(page: Path) -> None:
    """Write the tables of all datasets."""
    with TemporaryDirectory() as folder:
        page.write_text("\n".join(_page(partial(il.Study, results=folder))), encoding="utf-8")


def _page(study: partial[il.Study]) -> Iterator[str]:
    paper, varied = il.paper_impact(), {"velocity": [1.0, 2.0], "contact": ["hertz", "stronge"]}
    many = il.simulate_many(paper, GRID, duration="1 ms", varied=varied, combine="product")
    grid, sample = _grid(study), _sample(study)
    runs, draws = grid.run(workers=1), sample.run(workers=1)
    resolution, refinement = sample.recommend(workers=1), sample.refine(workers=1)
    indices, numerical = il.analyse(draws), il.analyse(draws, resolution, refinement)
    single = il.simulate(paper, GRID, duration="12 ms", frames=3)
    yield from _section("simulate", single, "`field_time` and what lies on it with `frames` alone.")
    yield from _section("simulate_many", many, "Every combination of two velocities and two laws.")
    yield from _section("Study.run", runs, STORED)
    yield from _section("Study.design", grid.design(), "The coordinates of the runs.")
    yield "## analyse\n\nAn analysis of all responses, by its name in `analyses`.\n"
    samples = {name: _ishigami(study, kind) for name, kind in SAMPLES.items() if kind.records}
    yield from _coordinates(indices)
    yield from _analyses([runs, runs.rename(nodes="element_size"), draws], samples)
    yield "### Numerical uncertainty\n\nFrom `resolution` and `refinement`.\n"
    yield from _table({name: numerical[name] for name in numerical if name not in indices})
    entry = {"quantity": "peak_force", "value": "24.5 kN", "standard_uncertainty": "1 kN"}
    force = {"title": "Force", "source": "an example", "measurements": [entry]}
    yield from _section("compare", il.compare(runs, force), "One row per measurement and model.")
    posterior, note = _posterior(study), "The attribute `answer` holds the findings in sentences."
    yield from _section("calibrate", posterior, note)
    yield from _section("Study.recommend", resolution, "As in resolution.nc.")
    yield from _section("Study.refine", refinement, "As in refinement.nc.")
    yield "## Flags\n\nThe bits of `status` and `remarks`.\n"
    for variable, (_, flags) in FLAGS.items():
        yield f"| `{variable}` | bit | meaning |\n|---|---|---|"
        yield from (f"| `{flag}` | {bit} | {words} |" for flag, (bit, words) in flags.items())
        yield ""


def _grid(study: partial[il.Study]) -> il.Study:
    return study(
        title="Grid",
        impact=il.paper_impact(),
        duration="1 ms",
        store={"histories": True, "samples": 20},
        sampling=il.Grid(
            parameters={"nodes": [21, 31, 41], "courant": [0.9, 0.6, 0.3], "points": [5, 7]}
        ),
    )


def _sample(study: partial[il.Study]) -> il.Study:
    return study(
        title="Sample",
        impact=il.paper_impact(),
        discretisation=GRID,
        duration="1 ms",
        responses=["peak_force"],
        store={"histories": True, "samples": 20},
        limits={"peak_force": "12 kN"},
        sampling=il.Sobol(
            base_samples=64,
            parameters={"velocity": il.Uniform(1, 2), "beam_depth": il.Uniform("26 mm", "29 mm")},
        ),
    )


def _ishigami(study: partial[il.Study], kind: type[RandomSample]) -> xr.Dataset:
    parameters = {name: il.Uniform("-3.14", "3.14") for name in ("x1", "x2", "x3")}
    sample = kind(parameters=parameters, **SIZES.get(kind.name(), {"samples": 128}))
    limits = {"value": 10.0} if any(record.of_limits for record in kind.records) else {}
    declared = study(title=kind.label, function="ishigami", sampling=sample, limits=limits)
    return declared.run(workers=1)


def _posterior(study: partial[il.Study]) -> xr.Dataset:
    prior = {"rate": il.Uniform(0, 1), "start": il.Uniform(5, 6)}
    decay = study(
        title="Decay",
        function=lambda rate, start: start - 2 * rate,
        sampling=il.Pawn(samples=128, parameters=prior),
    )
    entry = {"quantity": "value", "value": 4.5, "standard_uncertainty": 0.1}
    measurements = {"title": "Value", "source": "an example", "measurements": [entry]}
    return il.calibrate(decay, measurements, workers=1)


def _analyses(studies: list[xr.Dataset], samples: Mapping[str, xr.Dataset]) -> Iterator[str]:
    for name, entry in ANALYSES.items():
        module = resolve_name(entry.place)
        yield f"### {name}\n\nOf {entry.needs}.\n"
        if name == "sensitivity":
            for method, runs in samples.items():
                yield f"#### {method}\n"
                yield from _table(module.analysis(runs).data_vars)
        else:
            plans = ((runs, (runs.attrs.get("method"), runs.sizes, True)) for runs in studies)
            analyses = (module.analysis(runs) for runs, plan in plans if entry.possible(*plan))
            yield from _table(next(filter(len, analyses)).data_vars)


def _section(title: str, dataset: xr.Dataset, note: str = "") -> Iterator[str]:
    yield f"## {title}\n\n{note}\n"
    yield from _table(dataset.data_vars)
    yield from _coordinates(dataset)
    yield f"Attributes: {', '.join(f'`{name}`' for name in dataset.attrs)}.\n" * bool(dataset.attrs)


def _coordinates(dataset: xr.Dataset) -> Iterator[str]:
    yield ":::{dropdown} Coordinates"
    yield from _table(dataset.coords)
    yield ":::\n"


def _table(variables: Mapping[str, xr.DataArray]) -> Iterator[str]:
    if variables:
        yield "| variable | dimensions | unit | meaning |\n|---|---|---|---|"
    for name, values in variables.items():
        long_name = None if name in WRONG else values.attrs.get("long_name")
        meaning = str(long_name or MEANINGS[str(name)]).replace("|", r"\|")
        if flags := values.attrs.get("flag_meanings"):
            meaning += ": " + ", ".join(f"`{flag}`" for flag in str(flags).split())
        dims = ", ".join(f"`{dim}`" for dim in values.dims)
        yield f"| `{name}` | {dims} | {values.attrs.get('units', '')} | {meaning} |"
    yield ""
