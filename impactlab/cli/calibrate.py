"""Inference from measurements."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from impactlab.cli.interrupt import stop_solving
from impactlab.cli.options import StudyFile, given


def calibrate(
    study: StudyFile,
    measurements: Annotated[
        Path, typer.Argument(metavar="MEASUREMENTS", help="A file, measurements/NAME.yaml.")
    ],
    contact: Annotated[
        str, typer.Option(help="Contact laws to weigh, such as stronge,mjg. Default: the study's.")
    ] = "",
    model_error: Annotated[
        str, typer.Option(help="Standard error of the model itself, such as '3 %'.")
    ] = "0",
    workers: Annotated[int, typer.Option(min=1, help="Threads.")] = os.cpu_count() or 1,
) -> None:
    """Infer parameters and weights of contact laws from measurements.

    Solves the sample where it is not solved, calibrates its surrogate, and solves runs at the
    posterior to confirm it. Writes calibration.nc and its report, calibration.html, to
    results/NAME.
    """
    stop_solving()
    from impactlab.report.calibration import draw_and_tell
    from impactlab.study import steps
    from impactlab.study.calibration import calibrate as calibration
    from impactlab.study.engine import Engine
    from impactlab.study.schema.readers import read_study

    declared = read_study(study)
    folder = steps.results_folder(declared.name)
    laws = contact.replace(",", " ").split()
    error = given("--model-error", model_error, "1")
    posterior = calibration(declared, folder, measurements, Engine("threads", workers), laws, error)
    for line in draw_and_tell(posterior, folder):
        print(line)
