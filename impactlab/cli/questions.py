"""Questions to a study that need runs of their own."""

from __future__ import annotations

import os
from typing import Annotated

import typer

from impactlab.cli import stop_solving
from impactlab.cli.options import StudyFile, assigned, given

_DryRun = Annotated[
    bool, typer.Option("--dry-run", help="Print the cost of all runs allowed, and exit.")
]


def rare(
    study: StudyFile,
    samples: Annotated[int, typer.Option(help="Runs per level.")] = 500,
    runs: Annotated[int, typer.Option(help="Largest number of all runs.")] = 6000,
    variation: Annotated[
        float, typer.Option(help="Coefficient of variation of the probability to reach.")
    ] = 0.1,
    surrogate: Annotated[
        bool, typer.Option("--surrogate", help="Let a Gaussian process place the runs: far fewer.")
    ] = False,
    workers: Annotated[int, typer.Option(min=1, help="Threads.")] = os.cpu_count() or 1,
    dry_run: _DryRun = False,
) -> None:
    """Estimate the probability of a rare event.

    Draws samples that move towards the limit, solves them, and prints the probability and the
    likeliest way beyond the limit. Writes rare_event.nc and rare_event.html, its report, to
    results/NAME; runs are kept there, and are not solved again. --surrogate needs
    pip install 'impactlab[kriging]'.
    """
    stop_solving()
    from impactlab.report.console import print_estimate
    from impactlab.report.questions import report_rare_event
    from impactlab.study import steps
    from impactlab.study.engine import Engine
    from impactlab.study.rare_event import cost, rare_event
    from impactlab.study.schema.readers import read_study

    declared = read_study(study)
    folder, engine = steps.results_folder(declared.name), Engine("threads", workers)
    if dry_run:
        print_estimate(cost(declared, folder, workers, runs), workers)
        return
    result = rare_event(declared, folder, engine, samples, runs, variation, surrogate=surrogate)
    print(result.attrs["answer"], report_rare_event(result, folder), sep="\n")


def size(
    study: StudyFile,
    variables: Annotated[
        list[str], typer.Argument(metavar="PARAMETER...", help="Design variables, one or two.")
    ],
    probability: Annotated[float, typer.Option(help="Largest probability wanted.")],
    minimise: Annotated[
        str, typer.Option(metavar="mass|PARAMETER", help="Mass of the beam, or a design variable.")
    ] = "mass",
    maximise: Annotated[
        str, typer.Option(metavar="PARAMETER", help="Design variable that is to be large instead.")
    ] = "",
    samples: Annotated[int, typer.Option(help="Runs per level of an estimate.")] = 500,
    runs: Annotated[int, typer.Option(help="Largest number of runs of an estimate.")] = 6000,
    variation: Annotated[
        float, typer.Option(help="Coefficient of variation of a probability to reach.")
    ] = 0.1,
    workers: Annotated[int, typer.Option(min=1, help="Threads.")] = os.cpu_count() or 1,
    dry_run: _DryRun = False,
) -> None:
    """Find the lightest design with a small probability.

    Design variables have the distribution uniform in the study, which states their ranges; the
    other parameters scatter. Prints the values for which the response exceeds its limit with at
    most the probability wanted, confirmed by runs, and the numerical error there. Writes sizing.nc
    and sizing.html, its report, to results/NAME; runs are kept there, and are not solved again.
    """
    stop_solving()
    from impactlab.report.console import print_estimate
    from impactlab.report.questions import report_sizing
    from impactlab.study import steps
    from impactlab.study.engine import Engine
    from impactlab.study.rare_event import cost
    from impactlab.study.schema.readers import read_study
    from impactlab.study.sizing import most_runs, sizing

    declared = read_study(study)
    folder, engine = steps.results_folder(declared.name), Engine("threads", workers)
    if dry_run:
        runs = most_runs(declared, runs)
        print_estimate(cost(declared, folder, workers, runs), workers)
        return
    result = sizing(
        declared, folder, engine, variables, probability,
        minimise=minimise, maximise=maximise, samples=samples, runs=runs, target=variation,
    )  # fmt: skip
    print(result.attrs["answer"], report_sizing(result, folder), sep="\n")


def multifidelity(
    study: StudyFile,
    high: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="NAME=VALUE...",
            help="What the slow model has in place of the study's, such as beam_model=solid "
            "elements_per_radius=2, or nodes=601. Without it, all settings are the study's.",
        ),
    ] = None,
    pairs: Annotated[int, typer.Option(help="Runs of the slow model.")] = 40,
    runs: Annotated[int, typer.Option(help="Runs of the study's model; 0: the best number.")] = 0,
    budget: Annotated[
        str, typer.Option(help="Time of one core, such as '40 min', in place of --pairs.")
    ] = "",
    indices: Annotated[
        bool, typer.Option("--indices", help="Sobol indices of the slow model, too.")
    ] = False,
    predict: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE,...", help="Where to predict the slow model's answers."),
    ] = None,
    workers: Annotated[int, typer.Option(min=1, help="Threads.")] = os.cpu_count() or 1,
) -> None:
    """Estimate statistics of a slow model by a fast one.

    Solves few runs of the slow model and many of the study's, and prints mean, standard deviation
    and probability beyond the limit of the slow model's responses, with intervals and what they
    save. --predict velocity=5,10 --predict 'beam_depth=27 mm' adds its answers there, other
    parameters at their medians; it needs pip install 'impactlab[kriging]'. Writes multifidelity.nc
    and multifidelity.html, its report, to results/NAME; runs are kept there, and are not solved
    again.
    """
    stop_solving()
    from impactlab.report.questions import report_multifidelity
    from impactlab.study import steps
    from impactlab.study.engine import Engine
    from impactlab.study.multifidelity import multifidelity as statistics
    from impactlab.study.schema.readers import read_study

    declared = read_study(study)
    folder, engine = steps.results_folder(declared.name), Engine("threads", workers)
    seconds = given("--budget", budget, "s") if budget else 0.0
    texts = assigned(high) if high else {}
    values = {name: int(t) if t.isdecimal() else t for name, t in texts.items()} or None
    points = {name: text.split(",") for name, text in assigned(predict or []).items()}
    result = statistics(
        declared, folder, engine, values, pairs=pairs, runs=runs, budget=seconds, indices=indices,
        predict=points,
    )  # fmt: skip
    print(result.attrs["answer"], report_multifidelity(result, folder), sep="\n")
