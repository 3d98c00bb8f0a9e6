"""The command `witness`: the 3-D FE model beside the beam models."""

from __future__ import annotations

import logging
import os
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from impactlab.cli import stop_kept
from impactlab.cli.options import given, new_file, new_folder

if TYPE_CHECKING:
    from impactlab.fem3d.plan import RunPlan
    from impactlab.fem3d.solver.march import Progress

_UNITS = {"velocity": "m s-1", "contact": "", "element-size": "m", "patch": "m", "duration": "s"}
"""Units of the options that belong in the folder's name, in its order; a law has none."""


def witness(
    study: Annotated[
        Path | None,
        typer.Argument(
            metavar="[STUDY]",
            help="A study file: its base, fixed values. Default: the paper's case.",
        ),
    ] = None,
    velocity: Annotated[str, typer.Option(help="Impact velocity. Default: the study's.")] = "",
    contact: Annotated[
        str, typer.Option(help="Contact law of the beam models. Default: the study's.")
    ] = "",
    element_size: Annotated[
        str,
        typer.Option(
            help="Size of the elements about the contact, such as '0.5 mm'. Default: takes about a "
            "minute on two cores."
        ),
    ] = "",
    patch: Annotated[
        str,
        typer.Option(
            help="Half the side of the square in which sphere and beam may touch. Default: an "
            "estimate."
        ),
    ] = "",
    duration: Annotated[
        str,
        typer.Option(help="Simulated time, such as '0.45 ms'. Default: through the first contact."),
    ] = "",
    workers: Annotated[int, typer.Option(min=1, help="Threads.")] = os.cpu_count() or 1,
    output: Annotated[
        Path | None,
        new_folder(help="Default: results/NAME/witness, with the options given in its name."),
    ] = None,
    animate: Annotated[
        Path | None,
        new_file(".html", ".gif", ".mp4", help="Animate the section through the contact."),
    ] = None,
    deck: Annotated[
        str, typer.Option(help="abaqus or calculix: write its input deck, and solve nothing.")
    ] = "",
    elastic: Annotated[
        bool, typer.Option("--elastic", help="Write a deck without yielding (CalculiX needs it).")
    ] = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Print elements, time and memory, and solve nothing.")
    ] = False,
    force: Annotated[
        bool, typer.Option("--force", help="Run even if it takes hours, or all memory.")
    ] = False,
) -> None:
    """Compare the beam models with 3-D finite elements.

    A table compares their answers; fields, histories and figures are kept. Ctrl-C keeps what was
    computed until then.
    """
    from impactlab.fem3d.deck import FLAVOURS
    from impactlab.fem3d.plan import print_plan
    from impactlab.study.steps import results_folder

    if deck and deck not in FLAVOURS:
        raise ValueError(f"--deck {deck}: must be one of {', '.join(FLAVOURS)}")
    if elastic and not deck:
        raise ValueError("--elastic: applies to a deck only; select one with --deck")
    options = velocity, contact, element_size, patch, duration
    texts = {name: text for name, text in zip(_UNITS, options, strict=True) if text}
    plan = _planned(study, texts)
    # So that no answers to other options are overwritten.
    parts = [re.sub(r"[^\w.]+", "-", f"{name}-{text}") for name, text in texts.items()]
    folder = output or results_folder(plan.case.name) / "_".join(["witness", *parts])
    problem = "" if deck and plan.mesh else plan.problem(workers)
    if problem and not (dry_run or force):
        raise ValueError(problem)
    print_plan(plan, None if deck else workers, problem)
    if deck and not dry_run:
        _write_deck(plan, deck, folder, plastic=not elastic)
    elif not dry_run:
        _solve(plan, folder, workers, animate)


def _planned(study: Path | None, texts: Mapping[str, str]) -> RunPlan:
    """Return the plan of the study's base, or of the paper's case, with the options given."""
    from impactlab.fem3d.plan import case_of, planned
    from impactlab.study.schema.readers import read_impacts

    numbers = {
        name.replace("-", "_"): given(f"--{name}", texts[name], units)
        for name, units in _UNITS.items()
        if units and name in texts
    }
    speed = numbers.pop("velocity", None)
    impacts = read_impacts(study) if study else None
    case = case_of(impacts, velocity=speed, contact=texts.get("contact"))
    if case.held:
        values = ", ".join(f"{name} = {value}" for name, value in case.held.items())
        logging.getLogger("impactlab").info(
            "%s varies parameters of which this command takes one value: %s", case.file, values
        )
    return planned(case, **numbers)


def _write_deck(plan: RunPlan, flavour: str, folder: Path, *, plastic: bool) -> None:
    from impactlab.fem3d.comparison import check_writable
    from impactlab.fem3d.deck import FLAVOURS, write_deck

    check_writable(folder)
    path = folder / f"{flavour}{'' if plastic else '_elastic'}.inp"
    impact, mesh = plan.case.impact, plan.solved_mesh()
    write_deck(path, impact, mesh, flavour=flavour, duration=plan.duration, plastic=plastic)
    for limit in FLAVOURS[flavour].limits:
        logging.getLogger("impactlab").warning("%s: %s", path, limit)
    print(path)


@contextmanager
def _watched() -> Iterator[Progress]:
    """Show the share done; on Ctrl-C, break the 3-D run off at a checkpoint, to keep it whole."""
    from impactlab.study.progress import share_done

    with stop_kept() as asked_to_stop, share_done("3-D FE model") as show:

        def progress(share: float) -> None:
            show(share)
            if asked_to_stop() and share < 1.0:
                raise KeyboardInterrupt

        yield progress


def _solve(plan: RunPlan, folder: Path, workers: int, animate: Path | None) -> None:
    """Solve and compare; exit with 130 if interrupted, with 1 if the 3-D run failed."""
    from impactlab.fem3d.comparison import compare, print_comparison

    solid, responses, folder = compare(
        plan, folder, workers=workers, watched=_watched(), frames=animate is not None
    )
    print_comparison(responses, solid)
    if animate:
        from impactlab.fem3d.figures.run import animation

        print(animation(solid).save(animate))
    stopped = str(solid.attrs.get("stopped", ""))
    log = logging.getLogger("impactlab")
    if stopped.startswith("interrupted"):
        log.warning("%s: %s holds what was computed until then", stopped, folder)
        raise typer.Exit(130)
    if stopped:
        option = "--patch: " if "patch_needed" in solid.attrs else ""
        log.error("%s%s; %s holds what was computed until then", option, stopped, folder)
        raise typer.Exit(1)
    print(f"{folder}: witness.nc, witness.vtu (for ParaView), beams.nc, comparison.csv, figures/")
    print(folder / "report.html")
