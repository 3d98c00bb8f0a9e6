"""Morris' elementary effects, by SALib: a screening, cheap but without shares of the variance."""

from __future__ import annotations

import numpy as np
from SALib.analyze import morris

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
    path = levels(sample.inputs).reshape(trajectories, factors + 1, -1)
    moved = np.diff(path, axis=1) != 0
    members = np.array(sample.factors)[:, None] == np.array(sample.memberships)
    steps = (moved[:, :, None, :] == members).all(axis=-1)
    if not (steps.sum(axis=1) == 1).all():
        raise ValueError(
            f"the runs of {sample.study} are not Morris' trajectories, each step of which changes "
            "one parameter or group: solve the study again"
        )


def _estimate(outputs: Floats, sample: Sample, response: str) -> dict[str, Floats]:
    names, groups = list(sample.parameters), list(sample.memberships)
    problem = {"num_vars": len(names), "names": names, "groups": groups}
    bootstrap = {"num_resamples": sample.resamples, "conf_level": sample.confidence}
    settings = bootstrap | {"num_levels": sample.number("levels"), "seed": sample.rng(response)}
    found = morris.analyze(problem, levels(sample.inputs), outputs, **settings)
    alone = np.array([sample.memberships.count(name) == 1 for name in sample.factors])
    return {
        "morris_mu": np.where(alone, np.asarray(found["mu"], float), np.nan),
        "morris_mu_star": np.asarray(found["mu_star"], float),
        "morris_mu_star_interval": np.asarray(found["mu_star_conf"], float),
        "morris_sigma": np.asarray(found["sigma"], float),
    }


def levels(inputs: Floats) -> Floats:
    """Return the number of the level of each value, (runs, parameter), from 0 on.

    SALib sees a step in every change; the same level may come out of a quantile with another last
    digit.
    """
    found = np.empty(inputs.shape)
    for at, column in enumerate(inputs.T):
        values, places = np.unique(column, return_inverse=True)
        apart = np.diff(values) > SAME * np.abs(values).max()
        found[:, at] = np.concatenate([[0.0], np.cumsum(apart)])[places]
    return found


METHOD = Method("morris", _INDICES, _check, _estimate)
