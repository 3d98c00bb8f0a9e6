"""Differences between the paper's beam and the 3-D FE model: force, indentation, each effect."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from impactlab.fem3d.figures import differences
from impactlab.figures import access, labels, scales, style
from impactlab.figures.access import usable
from impactlab.figures.labels import display
from impactlab.model.impact import SOLID

TITLE = "Where the 3-D FE model differs from the paper's beam"
_HISTORIES = ("contact_force", "indentation")
_LABELS = {differences.TIMOSHENKO: "contact law (Timoshenko beam)", SOLID: "3-D FE model"}


def applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Return whether the runs separate the effects, and have histories."""
    return differences.separable(runs) and all(name in runs for name in _HISTORIES)


def caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """Return the caption, with the findings in numbers and the number of missing runs."""
    return (
        "Left: force against indentation (to mid-depth) as the contact law has it and as the 3-D "
        "solid answers, elastic and yielding. Right: by how much each effect changes the answer of "
        "the paper's beam (Euler-Bernoulli); bars: the numerical uncertainty of all runs that it "
        "is made of, left out where nothing bounds it. Shear and rotary inertia: Timoshenko's beam "
        "over Euler-Bernoulli's. 3-D elasticity of the contact: the elastic solid over the elastic "
        "Timoshenko beam under Hertz's law; what the local compliance through the depth and the "
        "waves in the sphere do. Contact law in yielding: what yielding does to the solid over "
        f"what it does under the contact law. {_finding(runs, analysis)} "
        f"{access.missing_note(runs, differences.NAMES)}".strip()
    )


@style.paper
def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """Draw force against indentation on the left, the effects on the right."""
    figure, (left, right) = style.panels(2, columns=2, height=72)
    _curves(left, runs)
    _effects(right, runs, analysis)
    style.legend(figure)
    return figure


def _curves(ax: Axes, runs: xr.Dataset) -> None:
    chosen = xr.Dataset({name: usable(runs, name) for name in _HISTORIES}).isel(
        differences.finest(runs)
    )
    force, depth = (display(runs[name]) for name in _HISTORIES)
    softest = float(runs["beam_yield_stress"].min())
    for at, (model, label) in enumerate(_LABELS.items()):
        for stress in np.sort(runs["beam_yield_stress"].values):
            run = chosen.sel(beam_model=model, beam_yield_stress=stress)
            pushed = np.flatnonzero(run["contact_force"].values > 0.0)
            if not pushed.size:
                continue
            first = slice(0, int(pushed[-1]) + 2)
            what = "yielding" if stress == softest else "elastic"
            ax.plot(
                depth(run["indentation"].values[first]),
                force(run["contact_force"].values[first]),
                color=style.COLOURS[0] if at == 0 else "black",
                linestyle=style.LINES[0 if stress == softest else 1],
                label=f"{label}, {what}",
            )
    if not ax.lines:
        style.remark(ax, "no finite values")
    ax.set_xlabel(labels.axis("indentation", depth.symbol))
    ax.set_ylabel(labels.axis("contact force", force.symbol))
    scales.linear(ax, "x")
    scales.linear(ax, "y")


def _effects(ax: Axes, runs: xr.Dataset, analysis: xr.Dataset) -> None:
    for at, name in enumerate(differences.NAMES):
        found = differences.effects(runs, analysis, name).values()
        shares = np.array([float(each.value) for each in found])
        widths = np.array([float(each.uncertainty) for each in found])
        there = np.flatnonzero(np.isfinite(shares))
        bars = np.where(np.isfinite(widths), widths, np.nan)
        marks = ax.errorbar(
            100.0 * shares[there],
            there + 0.24 * (at - 0.5),
            xerr=100.0 * bars[there],
            linestyle="",
            color=style.COLOURS[1 + at],
            marker=style.MARKERS[1 + at],
        )
        marks.set_label(labels.response(name))
    ax.axvline(0.0, label="_guide", **style.GUIDE)
    ax.set_yticks(range(len(differences.EFFECTS)), list(differences.EFFECTS.values()))
    ax.invert_yaxis()
    ax.set_xlabel(labels.axis("change of the beam's answer", "%"))
    scales.linear(ax, "x")


def _finding(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """Return the shares as sentences."""
    sentences = []
    for name in differences.NAMES:
        found = differences.effects(runs, analysis, name)
        if not np.isfinite([float(each.value) for each in found.values()]).all():
            continue
        listed = labels.listing(
            [
                f"{labels.number(100.0 * float(found[key].value), 2)} % by the {effect}"
                for key, effect in differences.EFFECTS.items()
                if key != "all"
            ]
        )
        total = labels.number(100.0 * float(found["all"].value), 2)
        sentences.append(f"The {labels.response(name)} changes by {listed}; together {total} %.")
    return " ".join(sentences)
