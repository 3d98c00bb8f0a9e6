"""Readers of measurements: files measurements/NAME.yaml, or mappings with the same keys."""

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Self

import xarray as xr
from pydantic import (
    BeforeValidator,
    Field,
    PlainValidator,
    StrictBool,
    ValidationInfo,
    model_validator,
)

from impactlab.analysis.measurements import Measurement
from impactlab.methods.runs import listed
from impactlab.model.parameters import PARAMETERS, Parameter
from impactlab.model.quantities import si
from impactlab.study.schema.yaml_file import read_mapping, read_text
from impactlab.validation import fields
from impactlab.validation.errors import unknown
from impactlab.validation.fields import plain
from impactlab.variables import RESPONSES, of_function

Conditions = Mapping[str, Any]
MeasurementSource = str | Path | Mapping[str, Any]
"""A file, or a mapping of the keys that a file has."""


def _quantity(value: Any, info: ValidationInfo) -> str:
    units: Mapping[str, str] = info.context["responses"]  # type: ignore[index]
    if not isinstance(value, str) or value not in units:
        raise ValueError(unknown("quantity", value, units))
    return value


def _number(value: Any, info: ValidationInfo) -> float | None:
    """Read a number in the unit of the quantity, which is wrong itself where it is absent."""
    quantity = info.data.get("quantity")
    return si(value, info.context["responses"][quantity]) if quantity else None  # type: ignore[index]


def _conditions(data: Any, info: ValidationInfo) -> Conditions:
    parameters: Mapping[str, Parameter] = info.context["parameters"]  # type: ignore[index]
    types = {name: fields.value_type(parameter) for name, parameter in parameters.items()}
    return fields.by_name("Conditions", types, data, info)


class _Entry(fields.FileSection):
    """One measured value, with its uncertainty and the meaning of that."""

    quantity: Annotated[str, BeforeValidator(_quantity)]
    value: Annotated[Any, PlainValidator(_number)]
    standard_uncertainty: Annotated[Any, PlainValidator(_number)] = None
    expanded_uncertainty: Annotated[Any, PlainValidator(_number)] = None
    coverage_factor: Annotated[fields.Number, Field(ge=1, le=10)] | None = None
    systematic_uncertainty: Annotated[Any, PlainValidator(_number)] = 0.0
    conditions: Annotated[Conditions, PlainValidator(_conditions)] = Field(default_factory=dict)
    note: fields.Text = ""

    @model_validator(mode="after")
    def _one_uncertainty(self) -> Self:
        stated = [self.standard_uncertainty, self.expanded_uncertainty]
        if sum(value is not None for value in stated) != 1:
            raise ValueError(
                "give one of standard_uncertainty (a standard deviation) and expanded_uncertainty "
                "(with its coverage_factor)"
            )
        if (self.expanded_uncertainty is None) != (self.coverage_factor is None):
            raise ValueError("expanded_uncertainty and coverage_factor belong together: give both")
        if self.standard <= 0:
            raise ValueError("the uncertainty must be above zero")
        if not 0 <= self.systematic_uncertainty < self.standard:
            raise fields.at_key(
                "systematic_uncertainty",
                "is a part of the standard uncertainty, so it must be at least 0 and below it "
                f"({self.standard:.6g} in SI units): lower it, or add it to the standard "
                "uncertainty (root of the sum of squares)",
            )
        return self

    @property
    def standard(self) -> float:
        """The standard uncertainty, in the unit of the quantity."""
        expanded = self.expanded_uncertainty
        return float(
            self.standard_uncertainty if expanded is None else expanded / self.coverage_factor
        )


class _File(fields.Heading):
    source: Annotated[fields.Text, Field(min_length=1)]
    simulated: StrictBool = False
    conditions: Annotated[Conditions, PlainValidator(_conditions)] = Field(default_factory=dict)
    measurements: Annotated[
        tuple[_Entry, ...], fields.requires(bool, "is empty: list at least one measurement")
    ]


def read_measurements(
    measurements: MeasurementSource, runs: xr.Dataset | None = None
) -> tuple[Measurement, ...]:
    """Read measurements: a file, or a mapping of the keys that a file has (docs/measurements.md).

    runs: whose responses and parameters may be measured beside those of impacts; those of a
    function alone. Raises StudyError
    with every problem: file, key, value, what to do; ValueError for runs of no study.
    """
    responses = {name: response.units for name, response in RESPONSES.items()}
    parameters = dict(PARAMETERS)
    if runs is not None and of_function(runs):
        responses, parameters = {}, {}
    if runs is not None:
        if "responses" not in runs.attrs:
            raise ValueError(
                "the runs are not those of a study: take what il.Study(...).run() gives"
            )
        for name in listed(runs, "responses"):
            responses.setdefault(name, str(runs[name].attrs.get("units", "1")))
        for name in listed(runs, "varied"):
            units = str(runs[name].attrs.get("units", "1"))
            parameters.setdefault(name, Parameter(name, units, name, ()))
    if isinstance(measurements, Mapping):
        file, data = "measurements", plain(measurements)
    else:
        file = str(measurements)
        data = read_mapping(read_text(Path(measurements)), file)
    read: Any = partial(fields.validated, parameters=parameters, responses=responses)
    content: _File = read(_File, data, file)
    source = f"{content.title} ({content.source})"
    measured = []
    for entry in content.measurements:
        value = entry.quantity, entry.value, entry.standard, responses[entry.quantity]
        conditions = {**content.conditions, **entry.conditions}
        shared = float(entry.systematic_uncertainty)
        measured.append(Measurement(*value, conditions, source, content.simulated, shared))
    return tuple(measured)
