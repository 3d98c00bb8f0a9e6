"""Morris' elementary effects: a screening, cheap but without shares of the variance."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Self

import numpy as np
from pydantic import Field, model_validator

from impactlab.methods.record import (
    Family,
    IndexVariable,
    Indices,
    Measure,
    SensitivityVerdict,
    wide,
)
from impactlab.methods.runs import Sample
from impactlab.methods.sampling import DrawnTogether, Grouped
from impactlab.types import Floats
from impactlab.validation.fields import Whole, at_key, requires

_EVEN = "must be even: the steps would favour some levels otherwise"
SAME = 1e-13  # difference, relative to the largest value, up to which two values are one level
_1991 = "Morris (1991), Technometrics 33, 161"
_2007 = "Campolongo et al. (2007), Environ. Model. Softw. 22, 1509, eq. 2"
_UNIT = (
    "in the unit of the response: its change over the change in probability of the parameter, "
    "that is over the whole range of a uniform one"
)
_VARIABLES = {
    "morris_mu": IndexVariable(
        "mean elementary effect",
        _1991,
        units=None,
        interval=False,
        comment=f"{_UNIT}; not given for a group of several parameters, whose signs differ",
    ),
    "morris_mu_star": IndexVariable(
        "mean absolute elementary effect", _2007, units=None, comment=_UNIT
    ),
    "morris_sigma": IndexVariable(
        "standard deviation of the elementary effects",
        _1991,
        units=None,
        interval=False,
        comment=f"{_UNIT}; not given for a group of several parameters",
    ),
}
FAMILY = Family(
    "morris_plane",
    "Elementary effects (Morris)",
    (Measure("morris_mu_star", "mean of magnitudes"),),
    "Mean of magnitudes µ*",
    "How far a response moves, on average, when one parameter goes through its whole range (µ*), "
    "and how much this depends on where the others are (σ).",
    shares=False,
)


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
    trajectories = effects.shape[1]
    widths = np.empty(len(effects))
    for parameter, sizes in enumerate(np.abs(effects)):
        resamples = sizes[rng.integers(trajectories, size=(sample.resamples, trajectories))]
        widths[parameter] = sample.quantile * resamples.mean(axis=1).std(ddof=1)
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


def _judge(indices: Mapping[str, Floats]) -> list[SensitivityVerdict]:
    effects = indices["morris_mu_star"]
    return wide(indices["morris_mu_star_interval"] / effects.max())


INDICES = Indices(
    "morris", _VARIABLES, FAMILY, _check, _estimate, _judge, order="steps from level to level"
)


@dataclass(frozen=True, kw_only=True)
class Morris(Grouped, DrawnTogether):
    """Trajectories for elementary effects: `trajectories` (D + 1) runs of D parameters.

    Parameters
    ----------
    parameters : mapping of str to distribution or Quantity
        Distribution, or one fixed value, by name of the parameter.
    seed : int, default 1
        Equal seeds give equal runs.
    trajectories : int
        Number of trajectories, at least 2.
    levels : int, default 4
        Number of levels of each parameter, even.
    groups : mapping of str to sequence of str, optional
        Parameters that get one index together, by name of the group.

    References
    ----------
    Morris (1991), Technometrics 33, 161.

    Examples
    --------
    >>> speed, depth = il.Uniform(1, 5), il.Uniform("26 mm", "29 mm")
    >>> sample = il.Morris(trajectories=20, parameters={"velocity": speed, "beam_depth": depth})
    """

    records = (INDICES,)
    label = "Morris trajectories"
    no_distribution = (
        "trajectories step over a few levels of each parameter, whatever its distribution"
    )
    blocks = "trajectories"
    trajectories: Annotated[Whole, Field(ge=2, le=1_000_000)]
    levels: Annotated[
        Whole, Field(ge=2, le=100), requires(lambda levels: levels % 2 == 0, _EVEN)
    ] = 4

    @property
    def runs(self) -> int:
        """Number of runs: per trajectory a start, and one step per parameter or group."""
        return self.trajectories * (self.group_count + 1)

    @model_validator(mode="after")
    def _check_ends(self) -> Self:
        if endless := [name for name, entry in self.varied.items() if not entry.bounds()]:
            reason = (
                "has no ends, where method morris has its outer levels: "
                "use truncated_normal, or another with low and high"
            )
            raise at_key(f"parameters.{endless[0]}.distribution", reason)
        return self

    def all_draws(self) -> Floats:
        """Draw trajectories of levels, 0 and 1 included: a start, and one step per factor."""
        (rng,) = np.random.default_rng(self.seed).spawn(1)  # as in SALib: same bits
        groups = list(self.group_of.values())
        names = list(dict.fromkeys(groups))
        group_numbers = [names.index(group) for group in groups]
        step = self.levels / (2.0 * (self.levels - 1))
        lower_levels = np.linspace(0, 1 - step, self.levels // 2)
        points = np.arange(len(names) + 1)[:, None]
        trajectories = np.empty((self.trajectories, len(names) + 1, len(groups)))
        for trajectory in trajectories:
            order = rng.permutation(len(names))[group_numbers]
            ascending = rng.choice([False, True], len(groups))
            starts = rng.choice(lower_levels, len(groups))
            trajectory[:] = starts + step * ((points > order) == ascending)
        return trajectories.reshape(-1, len(groups))
