"""Moving pictures of one run."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from impactlab.cli.options import assigned, given, new_file, stored_in

if TYPE_CHECKING:
    import xarray as xr


def animate(
    stored: Annotated[
        Path,
        typer.Argument(
            metavar="STORED",
            help="Output of `impactlab simulate`, a study's runs.nc, or results/NAME.",
            callback=stored_in("runs.nc"),
        ),
    ],
    values: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[NAME=VALUE...]", help="A run of the study, such as velocity=5 contact=mjg."
        ),
    ] = None,
    frames: Annotated[int, typer.Option(min=2, help="Frames, 25 per second.")] = 200,
    output: Annotated[
        Path | None,
        new_file(".html", ".gif", ".mp4", help="Default: animation.html beside STORED."),
    ] = None,
) -> None:
    """Animate one impact: beam, plastic zone and force.

    The HTML file needs no other one. MP4 needs ffmpeg, or pip install 'impactlab[video]'.
    """
    from impactlab.figures.animation import animation, with_fields
    from impactlab.files import opened

    path = output or stored.with_name("animation.html")
    with opened(stored, "impact", "runs") as runs:
        run = with_fields(_selected(runs, assigned(values or [])), frames)
        print(animation(run).save(path))


def _selected(runs: xr.Dataset, texts: dict[str, str]) -> xr.Dataset:
    """Return the runs with these values. Raises ValueError where there are none, naming all."""
    import numpy as np

    from impactlab.figures.access import design_dims
    from impactlab.figures.labels import listing
    from impactlab.validation.errors import unknown

    dims = {*design_dims(runs)}
    parameters = [str(name) for name, array in runs.coords.items() if dims.intersection(array.dims)]
    for name, text in texts.items():
        if name not in parameters:
            raise ValueError(f"{name}: {unknown('parameter', name, parameters)}")
        array = runs[name]
        if array.dtype.kind in "if":
            matches = np.isclose(array, given(name, text, array.attrs.get("units", "1")), atol=0.0)
        else:
            matches = array.values == text
        if not matches.any():
            present = listing([str(value) for value in np.unique(array.values)])
            raise ValueError(f"{name} = {text!r}: no run has it: choose from {present}")
        runs = runs.isel({array.dims[0]: matches.nonzero()[0]})
    return runs.squeeze([dim for dim in design_dims(runs) if runs.sizes[dim] == 1])
