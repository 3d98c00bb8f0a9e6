"""Morris' elementary effects: a screening, cheap but without shares of the variance."""

from __future__ import annotations

import numpy as np
import scipy  # its stats are loaded when first used

from impactlab.analysis.responses import Sample
from impactlab.analysis.sensitivity.method import Index, Method
from impactlab.types import Floats

SAME = 1e-13  # difference, relative to the largest value, up to which two values are one level
_1991 = "Morris (1991), Technometrics 33, 161"
_2007 = "Campolongo et al. (2007), Environ. Model. Softw. 22, 1509, eq. 2"
_UNIT = (
    "in the unit of the response: its change over the change in probability of the parameter, "
    "that is over the whole range of a uniform one"
)
_INDICES = {
    "morris_mu": Index(
        "mean elementary effect",
        _1991,
        units=None,
        interval=False,
        comment=f"{_UNIT}; not given for a group of several parameters, whose signs differ",
    ),
    "morris_mu_star": Index("mean absolute elementary effect", _2007, units=None, comment=_UNIT),
    "morris_sigma": Index(
        "standard deviation of the elementary effects",
        _1991,
        units=None,
        interval=False,
        comment=f"{_UNIT}; not given for a group of several parameters",
    ),
}


def _check(sample: Sample) -> None:
    sample.ordered()
    trajectories, factors = sample.number("trajectories"), len(sample.factors)
    sample.expect(trajectories * (factors + 1), f"{trajectories} trajectories of {factors} steps")
    moved = _directions(sample) != 0
    members = np.array(sample.factors)[:, None] == np.array(sample.memberships)
    steps = (moved[:, :, None, :] == members).all(axis=-1)
    if not (steps.sum(axis=1) == 1).all():
        raise ValueError(
            f"the runs of {sample.study} are not Morris' trajectories, each step of which changes "
            "one parameter or group: solve the study again"
        )


def _estimate(outputs: Floats, sample: Sample, response: str) -> dict[str, Floats]:
    trajectories, level_count = sample.number("trajectories"), sample.number("levels")
    changes = np.diff(outputs.reshape(trajectories, -1), axis=1)
    # exact: a trajectory has one step of each parameter
    effects = np.einsum("ij,ijk->ik", changes, _directions(sample)).T
    effects = effects / (level_count / (2.0 * (level_count - 1)))
    members = np.array(sample.factors)[:, None] == np.array(sample.memberships)
    sizes = members.sum(axis=1)

    def mean_of_group(values: Floats) -> Floats:
        return np.asarray((values * members).sum(axis=1) / sizes)

    return {
        "morris_mu": np.where(sizes == 1, mean_of_group(effects.mean(axis=1)), np.nan),
        "morris_mu_star": mean_of_group(np.abs(effects).mean(axis=1)),
        "morris_mu_star_interval": mean_of_group(_half_widths(effects, sample, response)),
        "morris_sigma": np.where(sizes == 1, mean_of_group(effects.std(axis=1, ddof=1)), np.nan),
    }


def _half_widths(effects: Floats, sample: Sample, response: str) -> Floats:
    """Return the bootstrap half-widths of each parameter's mean absolute effect."""
    (rng,) = sample.rng(response).spawn(1)
    quantile = scipy.stats.norm.ppf(0.5 + sample.confidence / 2)
    trajectories = effects.shape[1]
    widths = np.empty(len(effects))
    for parameter, sizes in enumerate(np.abs(effects)):
        resamples = sizes[rng.integers(trajectories, size=(sample.resamples, trajectories))]
        widths[parameter] = quantile * resamples.mean(axis=1).std(ddof=1)
    return widths


def _directions(sample: Sample) -> Floats:
    """Return the sign of each parameter's change, (trajectories, steps, parameters)."""
    paths = levels(sample.inputs).reshape(sample.number("trajectories"), -1, len(sample.parameters))
    return np.asarray(np.sign(np.diff(paths, axis=1)))


def levels(inputs: Floats) -> Floats:
    """Return the number of the level of each value, (runs, parameter), from 0 on.

    The same level may come out of a quantile with another last digit.
    """
    numbers = np.empty(inputs.shape)
    for parameter, column in enumerate(inputs.T):
        values, places = np.unique(column, return_inverse=True)
        apart = np.diff(values) > SAME * np.abs(values).max()
        numbers[:, parameter] = np.concatenate([[0.0], np.cumsum(apart)])[places]
    return numbers


METHOD = Method("morris", _INDICES, _check, _estimate)
