"""Questions to a study that need runs of their own."""

import os
from typing import Annotated

import typer

from impactlab.cli import stop_solving
from impactlab.cli.options import StudyFile, assigned, given


def multifidelity(
    study: StudyFile,
    high: Annotated[
        list[str],
        typer.Argument(
            metavar="NAME=VALUE...",
            help="What the slow model has in place of the study's, such as beam_model=solid "
            "elements_per_radius=2, or nodes=601.",
        ),
    ],
    pairs: Annotated[int, typer.Option(help="Runs of the slow model.")] = 40,
    runs: Annotated[int, typer.Option(help="Runs of the study's model; 0: the best number.")] = 0,
    budget: Annotated[
        str, typer.Option(help="Time of one core, such as '40 min', in place of --pairs.")
    ] = "",
    workers: Annotated[int, typer.Option(min=1, help="Threads.")] = os.cpu_count() or 1,
) -> None:
    """Estimate statistics of a slow model by a fast one.

    Solves few runs of the slow model and many of the study's, and prints mean, standard deviation
    and probability beyond the limit of the slow model's responses, with intervals and what they
    save. Writes multifidelity.nc and multifidelity.html, its report, to results/NAME; runs are kept
    there, and are not solved again.
    """
    stop_solving()
    from impactlab.report.rare_event import report_multifidelity
    from impactlab.study import steps
    from impactlab.study.engine import Engine
    from impactlab.study.multifidelity import multifidelity as statistics
    from impactlab.study.schema.readers import read_study

    declared = read_study(study)
    folder, engine = steps.results_folder(declared.name), Engine("threads", workers)
    seconds = given("--budget", budget, "s") if budget else 0.0
    values = {name: int(t) if t.isdecimal() else t for name, t in assigned(high).items()}
    result = statistics(declared, folder, engine, values, pairs=pairs, runs=runs, budget=seconds)
    print(result.attrs["answer"], report_multifidelity(result, folder), sep="\n")
