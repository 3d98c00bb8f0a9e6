"""Answers from a stored surrogate."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from impactlab.cli.options import assigned, given


def predict(
    surrogate: Annotated[
        Path, typer.Argument(metavar="SURROGATE", help="results/NAME/surrogate.nc.")
    ],
    values: Annotated[
        list[str],
        typer.Argument(metavar="NAME=VALUE...", help="Such as velocity=2 beam_depth='27 mm'."),
    ],
) -> None:
    """Predict the responses of one run without solving it.

    All parameters that the study varied have to be given. Beside each response stands the
    surrogate's error on runs that it was not fitted to.
    """
    from impactlab.analysis.surrogate import load_surrogate
    from impactlab.report.console import print_predictions

    model = load_surrogate(surrogate)
    texts = assigned(values)
    numbers = {name: given(name, text, model.units(name)) for name, text in texts.items()}
    print_predictions(model.predict(**numbers))
