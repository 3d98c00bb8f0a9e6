"""The form of a study file: which keys it has, and what may stand at each.

The keys, units and choices of parameters come from the table PARAMETERS: a new parameter needs
nothing here.
"""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, Field, PlainValidator, StrictBool

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.study.declaration.form import (
    Form,
    Number,
    Whole,
    above_zero,
    between,
    names,
    one_of,
    quantity,
)
from impactlab.study.declaration.heading import Heading
from impactlab.study.declaration.methods import Grid, Sample, sampling_reader
from impactlab.study.declaration.sections import Chosen, read_discretisation, read_impact
from impactlab.study.declaration.values import FACTORS
from impactlab.variables import ANALYSES, RESPONSES

Fraction = Annotated[Number, between(0.5, 0.999)]


class Store(Form):
    """What is kept of each run beside the responses.

    histories: force and displacements over time, at `samples` times. profiles: strains and
    deflection along the beam at the end.
    """

    histories: StrictBool = False
    profiles: StrictBool = False
    samples: Annotated[Whole, between(2, 100_000)] = 1000


class Analysis(Form):
    """How sensitivity indices and their intervals are made.

    confidence: level of the intervals. resamples: bootstrap resamples each. failed_runs: what
    becomes of a response that runs are missing of: no index is given, or a surrogate fitted on
    the other runs supplies them.
    """

    confidence: Fraction = 0.95
    resamples: Annotated[Whole, between(10, 100_000)] = 200
    failed_runs: Annotated[str, one_of("policy", ("fail", "impute"))] = "fail"


class StudyForm(Heading):
    """The file of a study of runs, read: SI numbers, objects of the model, a way of sampling."""

    impact: Annotated[Impact, PlainValidator(read_impact)]
    discretisation: Annotated[Chosen, PlainValidator(read_discretisation)] = Chosen(
        Discretisation()
    )
    duration: Annotated[quantity("s"), AfterValidator(above_zero)]  # type: ignore[valid-type]
    sampling: Annotated[Grid | Sample, PlainValidator(sampling_reader(FACTORS))]
    responses: Annotated[tuple[str, ...], names("response", RESPONSES)] = tuple(RESPONSES)
    analyses: Annotated[tuple[str, ...], names("analysis", ANALYSES)] = tuple(ANALYSES)
    store: Store = Field(default_factory=Store)
    analysis: Analysis | None = None
