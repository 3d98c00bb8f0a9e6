"""One run in a picture: force, motion, the loop of the contact, and the beam at the end."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from impactlab.figures import labels, scales, style
from impactlab.figures.labels import display
from impactlab.files import replaced

_MOTION = {"sphere_displacement": "sphere", "midspan_deflection": "beam at mid-span"}


def save(run: xr.Dataset, path: Path) -> None:
    """Draw a run of impactlab.simulate into a file, of the format that its name ends in."""
    figure = plot(run)
    with style.applied(), replaced(path) as unfinished:
        figure.savefig(unfinished, format=path.suffix[1:])


@style.paper
def plot(run: xr.Dataset) -> Figure:
    """Return the picture of a run of impactlab.simulate, of four panels."""
    figure, (force, motion, loop, beam) = style.panels(4, columns=2, height=52)
    _draw(force, run, "time", ["contact_force"], "contact force")
    peak, at = run["peak_force"], run["time_of_peak_force"]
    if np.isfinite(peak):
        place = display(run["time"])(at).item(), display(run["contact_force"])(peak).item()
        force.annotate(f"  {_quantity(peak)} at {_quantity(at)}", place, va="top")
    _draw(motion, run, "time", list(_MOTION), "displacement down")
    motion.legend()
    touching = run.where(run["contact_force"] > 0)
    _draw(loop, touching, "indentation", ["contact_force"], "contact force")
    strain = run["equivalent_plastic_strain"].max("z", keep_attrs=True)
    if bool((strain > 0).any()):
        _draw(beam, run.assign(plastic_strain=strain), "x", ["plastic_strain"], "largest PEEQ")
    else:
        _draw(beam, run, "x", ["deflection"], "deflection at the end")
        beam.invert_yaxis()
    for axes in (force, loop):
        axes.set(xlim=(0.0, None), ylim=(0.0, None))
    case = f"Sphere of {_quantity(run['sphere_radius'])} radius at {_quantity(run['velocity'])}"
    words = {"contact_duration": "first contact", "restitution": "restitution"}
    answers = [f"{text} {_quantity(run[name])}" for name, text in words.items() if run[name] >= 0]
    title = ": ".join(filter(None, (case, ", ".join(answers))))
    figure.suptitle(title, x=0.01, ha="left", fontsize=9)
    return figure


def _draw(axes: Axes, run: xr.Dataset, across: str, names: list[str], text: str) -> None:
    """Draw variables over another one, in the units of papers; contact ends where force does."""
    largest = max(names, key=lambda name: float(np.abs(run[name]).max()))
    x, y = display(run[across]), display(run[largest])
    for name, color in zip(names, style.COLOURS, strict=False):
        axes.plot(x(run[across]), y(run[name]), color=color, label=_MOTION.get(name))
    words = str(run[across].attrs["long_name"]).partition(" (")[0]
    axes.set_xlabel(labels.axis(words, x.symbol))
    axes.set_ylabel(labels.axis(text, y.symbol))
    scales.linear(axes, "xy")
    axes.margins(x=0.0)


def _quantity(scalar: xr.DataArray) -> str:
    unit = display(scalar)
    return f"{labels.number(unit(scalar).item(), 3)} {unit.symbol}".rstrip()
