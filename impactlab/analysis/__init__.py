"""Analyses of the runs of a study, and how far to trust them: from runs.nc to analysis.nc."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from impactlab import wings
from impactlab.methods import NO_DISTRIBUTION, SAMPLES
from impactlab.methods.grid import Grid
from impactlab.methods.sobol import Sobol


@dataclass(frozen=True)
class AnalysisEntry:
    """An analysis of the runs of a study.

    place: path of an object in impactlab.analysis with `analysis(runs)`: its variables with
    `response` or `history` among their coordinates, none where it cannot analyse the runs. needs:
    the runs that it needs, in words. possible: whether a study has them, by its method of sampling,
    the number of values on each axis of its grid, and whether it stores histories.
    """

    place: str
    needs: str
    possible: Callable[[str, Mapping[str, int], bool], bool]


def _grid(least: int, *axes: str) -> tuple[str, Callable[[str, Mapping[str, int], bool], bool]]:
    """Return needs and condition of an analysis along an axis of a grid."""
    needs = f"a grid that varies {' or '.join(f'`{axis}`' for axis in axes)} over at least {least} "
    return needs + "values", lambda _, sizes, __: any(sizes.get(axis, 0) >= least for axis in axes)


_AXES = "impactlab.analysis.convergence.axes:"
ANALYSES: dict[str, AnalysisEntry] = {
    "convergence_in_nodes": AnalysisEntry(f"{_AXES}NODES", *_grid(3, "nodes")),
    "convergence_in_time_step": AnalysisEntry(f"{_AXES}TIME_STEP", *_grid(3, "courant")),
    **{
        f"convergence_in_{model.axis}": AnalysisEntry(
            model.references["axis"], *_grid(3, *(size.name for size in model.sizes))
        )
        for model in wings.models().values()
    },
    "convergence_in_points": AnalysisEntry(
        "impactlab.analysis.convergence.points", *_grid(2, "points")
    ),
    "sensitivity": AnalysisEntry(
        "impactlab.analysis.sensitivity",
        "a sample (any method but grid)",
        lambda method, *_: method in SAMPLES,
    ),
    "sensitivity_over_time": AnalysisEntry(
        "impactlab.analysis.sensitivity.over_time",
        "a Sobol sample with histories (store: {histories: true})",
        lambda method, _, histories: method == Sobol.name() and histories,
    ),
    "distribution": AnalysisEntry(
        "impactlab.analysis.distribution",
        f"a sample that represents it (any method but {' or '.join(NO_DISTRIBUTION)})",
        lambda method, *_: method in SAMPLES.keys() - NO_DISTRIBUTION.keys(),
    ),
    "surrogate": AnalysisEntry(
        "impactlab.analysis.surrogate",
        "a sample (any method but grid)",
        lambda method, *_: method != Grid.name(),
    ),
}
"""The registry of analyses, by the names that study files have for them."""
