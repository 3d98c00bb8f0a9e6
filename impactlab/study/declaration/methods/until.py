"""When a growing sample is large enough."""

from __future__ import annotations

from typing import Annotated

from impactlab.study.declaration.form import Form, Names, Number, Whole, between
from impactlab.study.declaration.methods.sampling import MOST_RUNS


class Until(Form):
    """The sample is doubled until its intervals are narrow enough, within a number of runs.

    interval: largest half-width of the interval of a first or total-order index. runs: the most
    that may be made. responses: of which this is asked; none: of all.
    """

    interval: Annotated[Number, between(0.001, 0.5)]
    runs: Annotated[Whole, between(1, MOST_RUNS)]
    responses: Names | None = None
