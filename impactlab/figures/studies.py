"""Figures of several studies side by side: a colour per study, on common axes."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing

from impactlab.analysis.distribution import cumulative, drawn_outputs
from impactlab.figures import (
    access,
    curves,
    draw,
    labels,
    measures,
    record,
    scales,
    style,
)
from impactlab.figures.data import name_places
from impactlab.figures.grids import parameter_axis
from impactlab.figures.labels import Display, display
from impactlab.figures.record import LEAD
from impactlab.methods.record import Family

_THICK = 0.78  # thickness of all bars of a row together, in rows
_MATTERS = 0.01
"""Smallest share of the largest index with which a parameter has a row."""
_STEPS = 300  # most steps drawn of a cumulative curve
_LINES = 3  # most curves per study
_WIDER = 1.6
"""Step in line width between successive studies, pt."""
_FEWEST = 2  # smallest number of common values for an axis


@dataclass(frozen=True)
class StudyResults:
    """The results of one of the studies: its name, a label that tells it apart, two datasets."""

    name: str
    label: str
    runs: xr.Dataset
    analysis: xr.Dataset

    def is_usable(self, response: str) -> bool:
        """Return whether the analysis has indices of a response that are no worse than imprecise.

        Differences take the width of intervals into account.
        """
        if not access.known(self.analysis, response):
            return False
        verdict = access.verdict(self.analysis, access.VERDICT, response)
        return verdict is None or verdict.sound or verdict.flag == "wide_intervals"


def shared_responses(studies: Sequence[StudyResults]) -> list[str]:
    """Return the responses that all studies have, in the order of the first."""
    others = [access.responses(study.runs) for study in studies[1:]]
    return [
        name for name in access.responses(studies[0].runs) if all(name in names for names in others)
    ]


def shared_family(studies: Sequence[StudyResults]) -> Family | None:
    """Return the family of indices that all studies have; None without."""
    families = [measures.families(study.runs, study.analysis) for study in studies]
    return next((entry for entry in families[0] if all(entry in f for f in families)), None)


def shared_axis(studies: Sequence[StudyResults]) -> str:
    """Return the parameter over which responses of all grids are drawn; "" where they share none.

    Parameters of the impact come first.
    """
    runs = [study.runs for study in studies]
    numbers = [
        name
        for name in (*access.physical(runs[0]), *access.varied(runs[0]))
        if runs[0][name].dtype.kind in "if"
    ]
    shared = (n for n in numbers if all(r.sizes.get(n, 0) >= _FEWEST for r in runs))
    return next(shared, "")


def common_display(studies: Sequence[StudyResults], name: str) -> Display:
    """Return the display unit of a variable over all studies."""
    values = [access.usable(study.runs, name) for study in studies]
    largest = max(float(np.nanmax(np.abs(array), initial=0.0)) for array in values)
    return display(xr.DataArray(largest, name=name, attrs=studies[0].runs[name].attrs))


@dataclass(frozen=True)
class _Panels:
    """A figure of one panel per response. plot: draws those of some responses."""

    name: str
    title: str
    caption: str
    plot: Callable[[Sequence[str]], Drawing]
    responses: list[str]

    def figure(self) -> record.Figure:
        """Return the record that `draw` takes."""
        plot, responses, caption = style.paper(self.plot), self.responses, self.caption
        always, text = (lambda runs, analysis: True), (lambda runs, analysis: caption)
        return record.Figure(
            self.name, self.title, always, lambda runs, analysis: plot(responses), text
        )


def draw_studies(
    studies: Sequence[StudyResults], lead: str, comparison: xr.Dataset, folder: Path
) -> list[Path]:
    """Draw the figures of a comparison into a folder; lead: the response of its headline.

    A figure of that response alone comes first.
    """
    figures = _figures(studies)
    first = next((panels for panels in figures if lead in panels.responses), None)
    if first is not None:
        title = f"{first.title}: {labels.response(lead)}"
        figures = [panels for panels in figures if panels != first or panels.responses != [lead]]
        figures.insert(0, replace(first, name=LEAD, title=title, responses=[lead]))
    drawings = [(panels.figure(), (comparison, comparison)) for panels in figures]
    return draw.draw(drawings, folder, str(comparison.attrs["study"]), made_from=comparison)


def _figures(studies: Sequence[StudyResults]) -> list[_Panels]:
    """Return the figures that apply to these studies."""
    names, family, runs = shared_responses(studies), shared_family(studies), studies[0].runs
    colours = f"A colour for each of {labels.listing([study.label for study in studies])}."
    figures = []
    usable = [name for name in names if sum(study.is_usable(name) for study in studies) > 1]
    if family and usable:
        text = (
            f"{family.meaning} Shown: {family.ranked_by(studies[0].analysis).label}. Lines on the "
            f"bars: {access.confidence(studies[0].analysis)} intervals. Parameters that matter "
            f"nowhere have no row. {colours}"
        )
        title, plot = f"{family.title} side by side", partial(_indices, studies, family)
        figures.append(_Panels("compared_indices", title, text, plot, usable))
    if all("quantile" in study.analysis for study in studies):
        text = f"Share of the draws with a response up to each value, with its band. {colours}"
        title, plot = "Distributions side by side", partial(_distributions, studies)
        figures.append(_Panels("compared_distributions", title, text, plot, names))
    if not access.is_sample(runs) and (along := shared_axis(studies)):
        text = (
            f"Line styles tell further parameters apart; a jump is not joined. {colours} Lines of "
            "earlier studies are wider."
        )
        title = f"Responses against the {labels.parameter(runs[along])}"
        plot = partial(_curves, studies, along)
        figures.append(_Panels("compared_responses", title, text, plot, names))
    return figures


def _indices(studies: Sequence[StudyResults], family: Family, names: Sequence[str]) -> Drawing:
    """Draw a panel per response, a row per parameter, a bar per study."""
    measure = family.ranked_by(studies[0].analysis).name
    parameters, meanings = rows_of(studies, measure, names)
    height = 12 + (1.4 + 2.3 * len(studies)) * len(parameters)
    figure, axes = style.response_panels(names, height, beneath=8)
    for name, ax in axes.items():
        unit = Display(1.0, "") if family.shares else common_display(studies, name)
        for number, study in enumerate(studies):
            _bars(ax, study, measure, name, parameters, number, len(studies), unit)
        ax.axvline(0.0, color="0.15", linewidth=0.6)
        name_places(ax, "y", meanings)
        ax.tick_params(axis="y", length=0, labelleft=style.starts_row(ax))
        ax.grid(visible=False, axis="y")
        ax.set_ylim(len(parameters) - 0.5, -0.5)
        ax.set_xlim(min(ax.get_xlim()[0], 0.0), None)
        scales.linear(ax, "x")
        if not family.shares:
            ax.set_xlabel(labels.axis(labels.response(name), unit.symbol))
    order = [study.label for study in studies]
    return style.finish(figure, family.axis if family.shares else "", order=order)


def rows_of(
    studies: Sequence[StudyResults], measure: str, names: Sequence[str]
) -> tuple[list[str], list[str]]:
    """Return the parameters that matter in any study, the largest index first, and meanings."""
    size: dict[str, float] = {}
    meanings: dict[str, str] = {}
    for study in studies:
        meanings |= dict(
            zip(measures.parameters(study.analysis), measures.meanings(study.analysis), strict=True)
        )
        for name in filter(study.is_usable, names):
            values = np.abs(measures.index(study.analysis, measure, name).values)
            shares = values / np.nanmax(values)
            for parameter, share in zip(measures.parameters(study.analysis), shares, strict=True):
                size[parameter] = max(size.get(parameter, 0.0), float(np.nan_to_num(share)))
    ordered = sorted(size, key=lambda parameter: -size[parameter])
    parameters = [parameter for parameter in ordered if size[parameter] > _MATTERS]
    return parameters, [meanings[parameter] for parameter in parameters]


def _bars(
    ax: Axes,
    study: StudyResults,
    measure: str,
    response: str,
    parameters: list[str],
    number: int,
    count: int,
    unit: Display,
) -> None:
    """Draw the indices of one study where they are usable, as the `number`th bar of each row."""
    listed = measures.parameters(study.analysis)
    rows = [row for row, parameter in enumerate(parameters) if parameter in listed]
    if not study.is_usable(response) or not rows:
        ax.plot([], [], label=study.label, **_colour(number), linewidth=4)
        return
    index = measures.index(study.analysis, measure, response)
    places = [listed.index(parameters[row]) for row in rows]
    margins = index.margins[places]
    look: Any = {"error_kw": {"elinewidth": 0.8, "ecolor": "0.15"}, **_colour(number)}
    ax.barh(
        np.array(rows) + _THICK * ((number + 0.5) / count - 0.5),
        unit(index.values[places]),
        _THICK / count,
        xerr=unit(np.where(np.isfinite(margins), margins, 0.0)),
        label=study.label,
        **look,
    )


def _colour(number: int) -> dict[str, Any]:
    return {"color": style.distinct(number)["color"]}


def _distributions(studies: Sequence[StudyResults], names: Sequence[str]) -> Drawing:
    """Draw a panel per response: the cumulative curve of each study, with its band."""
    figure, axes = style.response_panels(names, height=42)
    for name, ax in axes.items():
        unit, drawn = common_display(studies, name), []
        ax.set_title(labels.axis(labels.response(name), unit.symbol), loc="left")
        for number, study in enumerate(studies):
            level = float(study.analysis.attrs.get("confidence", 0.95))
            values, share, low, high = cumulative(drawn_outputs(study.runs, name), level)
            if not values.size:
                continue
            steps = scales.spread(values.size, _STEPS)
            x, look = unit(values[steps]), style.LINES[number % len(style.LINES)]
            ax.fill_between(x, low[steps], high[steps], step="post", alpha=0.25, **_colour(number))
            ax.step(
                x, share[steps], where="post", label=study.label, linestyle=look, **_colour(number)
            )
            drawn.append(x)
        if not drawn:
            style.empty(ax)
            continue
        ax.set_ylim(0.0, 1.0)
        scales.linear(ax, "y", 4)
        scales.fit(ax, "x", np.concatenate(drawn))
    order = [study.label for study in studies]
    return style.finish(figure, y="Share of the draws (–)", order=order)


def _curves(studies: Sequence[StudyResults], along: str, names: Sequence[str]) -> Drawing:
    """Draw a panel per response over a parameter: a colour per study, a line style per curve."""
    figure, axes = style.response_panels(names, height=42)
    across = display(studies[0].runs[along])
    for name, ax in axes.items():
        unit, places = common_display(studies, name), []
        for number, study in enumerate(studies):
            selected = curves.plan(
                study.runs, name, along=[along], prefer=access.physical(study.runs), most=_LINES
            )
            x = across(study.runs[along].values)
            order = np.argsort(x)
            for line, curve in enumerate(selected.curves):
                settings = (labels.brief(study.runs[d], curve.where[d]) for d in selected.shown)
                shown = curves.Selection({}, ", ".join([study.label, *settings]), (number, line))
                y = unit(access.usable(study.runs, name).isel(curve.where).values)
                if curves.add(ax, *curves.broken(x[order], y[order]), shown, markers=False):
                    below = len(studies) - 1 - number  # wider, to be seen where curves coincide
                    ax.lines[-1].set(linewidth=1.2 + _WIDER * below, zorder=3.0 - 0.1 * below)
            places.append(x)
        ax.set_title(labels.axis(labels.response(name), unit.symbol), loc="left")
        scales.fit(ax, "x", np.concatenate(places))
        scales.fit(ax, "y", scales.drawn(ax, "y"))
        if not ax.lines:
            style.empty(ax)
    return style.finish(figure, parameter_axis(studies[0].runs[along]))
