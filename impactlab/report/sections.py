"""The sections of a study's page, in their order, but for convergence, notes and provenance."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr

from impactlab import wings
from impactlab.figures import labels
from impactlab.figures.access import is_sample
from impactlab.figures.measures import asked
from impactlab.figures.scatter import scatters
from impactlab.report import answers, inputs, outcome, sensitivity
from impactlab.report.section import Section


def sections(
    runs: xr.Dataset, analysis: xr.Dataset, indices: str = ""
) -> tuple[list[Section], list[Section]]:
    """What stands before the section on convergence, and what after it.

    A grid: what was run, how the runs ended, what a 3-D witness says; results. A sample: what was
    varied, distributions, scatters, indices, ranking; failures, numerical uncertainty. indices:
    name of the file of all indices, "" where there is none.
    """
    if not is_sample(runs):
        own = wings.added("sections", runs)
        found = own(runs, analysis) if own else []
        return [_runs(runs), _outcome(runs, analysis), *found], [_results(runs)]
    of_sample = [
        _runs(runs),
        _results(runs, ["response_distributions"]),
        _scatter(runs),
        *sensitivity.sections(runs, analysis, indices),
        _outcome(runs, analysis, ["failure_shares", "failure_map"]),
        *sensitivity.last(runs, analysis),
    ]
    return of_sample, []


def figures(names: list[str]) -> Section:
    """The figures of no other section."""
    lead = "" if names else "No figure applies to what this study keeps."
    return Section("figures", "Figures", lead, figures=names)


def _runs(runs: xr.Dataset) -> Section:
    title = "What was varied, and how" if is_sample(runs) else "What was run"
    tables = [inputs.varied_parameters(runs), inputs.fixed_parameters(runs)]
    return Section("runs", title, tables=[table for table in tables if table.rows])


def _results(runs: xr.Dataset, drawn: list[str] | None = None) -> Section:
    title = "Distribution of each response" if drawn else "Results"
    tables = [answers.ranges(runs), *answers.values(runs)]
    return Section("results", title, tables=tables, figures=drawn or [])


def _scatter(runs: xr.Dataset) -> Section:
    lead = (
        "A line that bends or tilts is a parameter that matters by itself; points that fan out "
        "around a flat line hint at one that matters together with others."
    )
    names = list(scatters(runs))
    return Section("scatter", "Each response against each parameter", lead, figures=names)


def _outcome(runs: xr.Dataset, analysis: xr.Dataset, drawn: list[str] | None = None) -> Section:
    found = outcome.outcome(runs)
    imputed = [*_imputed(runs, analysis)]
    if not found.failed:
        lead = f"All {found.total} runs gave every response."
        return Section("outcome", "How the runs ended", lead, imputed)
    lead = f"{found.failed} of {found.total} runs failed, that is, miss at least one response."
    tables = [found.reasons, found.listed]
    return Section("outcome", "How the runs ended", lead, imputed, tables, drawn or [])


def _imputed(runs: xr.Dataset, analysis: xr.Dataset) -> Iterator[str]:
    """A sentence a response whose indices rest on values from a surrogate."""
    if "imputed_share" not in analysis:
        return
    for name in asked(runs, analysis):
        share = float(np.nan_to_num(analysis["imputed_share"].sel(response=name)))
        if share > 0:
            yield (
                f"For the indices of the {labels.response(name)}, a surrogate supplied the value "
                f"of {labels.number(100 * share, 2)} % of the runs."
            )
