"""Figures of a study with 3-D runs: all models against velocity, and what makes them differ."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedFormatter
from matplotlib.transforms import ScaledTranslation

from impactlab.fem3d.figures import differences
from impactlab.figures import access, labels, record, scales, style
from impactlab.figures.access import usable
from impactlab.figures.labels import display
from impactlab.model.impact import SOLID

_NAMES = (
    *("peak_force", "contact_duration", "maximum_deflection"),
    *("permanent_indentation", "maximum_indentation"),
)
"""Responses to draw, most important first."""
_MOST = 3
_LEAST, _ROOM = 2.0, 2.0
"""Least half-height of a panel of differences in %; its largest, over the largest difference."""


@record.figure(
    "The beam models and the 3-D FE model",
    "Above: each model on its finest grid. Below: its difference from the 3-D "
    "finite-element model, in parts of that; bars: the numerical uncertainty of both models "
    "together, left out where nothing bounds it and cut at the panel's edge. Markers below are "
    "drawn a little beside their velocity, not to hide each other.",
    lambda runs, analysis: differences.differ(runs) and bool(_drawn(runs)),
    lambda runs, analysis: (access.missing_note(runs, _drawn(runs)),),
)
def witness(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """Draw one column per response: values above, differences from the 3-D FE model below."""
    names = _drawn(runs)
    figure, axes = style.panels(2 * len(names), columns=len(names), height=52)
    for at, name in enumerate(names):
        above, below = axes[at], axes[at + len(names)]
        _values(above, runs, analysis, name)
        _differences(below, runs, analysis, name)
        for ax in (above, below):
            scales.logarithmic(ax, "x", runs["velocity"].values)
            scales.at(ax, "x", runs["velocity"].values)
        below.set_xlim(0.85 * runs["velocity"].values.min(), 1.18 * runs["velocity"].values.max())
        below.set_xlabel(labels.axis(labels.parameter("velocity"), "m/s"))
    axes[len(names)].set_ylabel(labels.wrapped_axis("difference from the 3-D FE model", "%", 24))
    style.legend(
        figure,
        "Model of the beam",
        [labels.beam_model(model) for model in differences.models(runs)],
    )
    return figure


def _drawn(runs: xr.Dataset) -> list[str]:
    return [name for name in _NAMES if name in access.responses(runs)][:_MOST]


def _look(at: int) -> dict[str, Any]:
    """Return the style: 3-D black, others as in all figures, one marker each."""
    colour = "black" if at == 0 else style.COLOURS[at - 1]
    return {"color": colour, "marker": style.MARKERS[at], "linestyle": style.LINES[at]}


def _values(ax: Axes, runs: xr.Dataset, analysis: xr.Dataset, name: str) -> None:
    unit = display(usable(runs, name))
    for at, model in enumerate(differences.models(runs)):
        values = unit(differences.side(runs, analysis, name, model).value)
        if np.isfinite(values).any():
            ax.plot(runs["velocity"].values, values, label=labels.beam_model(model), **_look(at))
    ax.set_title(labels.sentence(labels.response(name)), loc="left")
    ax.set_ylabel(labels.axis(labels.response(name), unit.symbol))
    if not ax.lines:
        style.remark(ax, "no finite values")
        return
    shown = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in ax.lines])
    if np.nanmin(shown) > 0:
        scales.logarithmic(ax, "y", shown)


def _differences(ax: Axes, runs: xr.Dataset, analysis: xr.Dataset, name: str) -> None:
    first, *others = differences.models(runs)
    against = differences.side(runs, analysis, name, first)
    speeds = runs["velocity"].values
    ends: list[float] = []
    for at, model in enumerate(others, 1):
        gap = differences.difference([differences.side(runs, analysis, name, model)], [against])
        bars = np.where(np.isfinite(gap.uncertainty), 100.0 * gap.uncertainty, np.nan)
        points = 2.2 * (at - 0.5 * (len(others) + 1))  # beside its velocity, in the picture alone
        shift = ScaledTranslation(points / 72.0, 0.0, ax.figure.dpi_scale_trans)
        if np.isfinite(gap.value).any():
            look = _look(at) | {"label": labels.beam_model(model)}
            look |= {"elinewidth": 0.8, "transform": ax.transData + shift}
            ax.errorbar(speeds, 100.0 * gap.value, yerr=bars, **look)
            reach = np.nan_to_num(bars)
            ends += [*(100.0 * gap.value - reach), *(100.0 * gap.value + reach)]
    ax.set_title(f"Difference in {labels.response(name)}", loc="left")
    if not ax.containers:
        style.remark(ax, "no finite values")
        return
    ax.axhline(0.0, label="_guide", **style.GUIDE)
    scales.linear(ax, "y")
    middle = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in ax.lines])
    room = _ROOM * max(_LEAST, float(np.nanmax(abs(middle))))
    low, high = float(np.nanmin([0.0, *ends])), float(np.nanmax([0.0, *ends]))
    ax.set_ylim(max(1.1 * low, -room), min(1.1 * high, room))


_HISTORIES = ("contact_force", "indentation")
_LABELS = {differences.TIMOSHENKO: "contact law (Timoshenko beam)", SOLID: "3-D FE model"}


@record.figure(
    "Where the 3-D FE model differs from the paper's beam",
    "Left: force against indentation (to mid-depth) as the contact law has it and as the 3-D "
    "solid answers, elastic and yielding. Right: by how much each effect changes the answer of "
    "the paper's beam (Euler-Bernoulli); bars: the numerical uncertainty of all runs that it "
    "is made of, left out where nothing bounds it. Shear and rotary inertia: Timoshenko's beam "
    "over Euler-Bernoulli's. 3-D elasticity of the contact: the elastic solid over the elastic "
    "Timoshenko beam under Hertz's law; what the local compliance through the depth and the "
    "waves in the sphere do. Contact law in yielding: what yielding does to the solid over "
    "what it does under the contact law.",
    lambda runs, analysis: differences.separable(runs) and all(name in runs for name in _HISTORIES),
    lambda runs, analysis: (
        _finding(runs, analysis),
        access.missing_note(runs, differences.NAMES),
    ),
)
def witness_parts(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
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
    scales.linear(ax, "xy")


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
    ax.set_yticks(range(len(differences.EFFECTS)))
    ax.yaxis.set_major_formatter(FixedFormatter(list(differences.EFFECTS.values())))
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


FIGURES = {figure.name: figure for figure in (witness, witness_parts)}
"""Figures of a study, by name, in the order of the report."""
