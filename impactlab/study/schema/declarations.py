"""Studies and verifications as their files define them, and the sections of a study of impacts."""

import hashlib
from collections.abc import Mapping
from dataclasses import MISSING, dataclass, field
from functools import reduce
from pathlib import Path
from typing import Annotated, Any

from pydantic import (
    BeforeValidator,
    Field,
    PlainValidator,
    StrictBool,
    StrictStr,
    ValidationInfo,
    WrapValidator,
    create_model,
)

from impactlab.analysis import ANALYSES
from impactlab.methods import read_sampling
from impactlab.methods.grid import Grid
from impactlab.methods.sampling import RandomSample
from impactlab.methods.sobol import Sobol
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import BASES, Impact, paper_impact
from impactlab.model.parameters import PARAMETERS, with_values
from impactlab.model.quantities import duration, symbol
from impactlab.solver import SCHEMES
from impactlab.solver.outputs import GROWING
from impactlab.validation.fields import (
    FileSection,
    Heading,
    Names,
    Number,
    Whole,
    at_key,
    by_name,
    names,
    one_of,
    quantity,
    value_type,
)
from impactlab.validation.refusals import Base, refusal
from impactlab.variables import RESPONSES

_RESPONSES = names("response", RESPONSES, GROWING)


class Auto(FileSection):
    """The key `auto`: a discretisation to be found by pilot runs on corner cases of the study.

    tolerance: relative numerical uncertainty; responses: those that it limits; None: all.
    """

    tolerance: Annotated[Number, Field(ge=1e-4, le=0.5)] = 0.01
    responses: Annotated[tuple[str, ...], _RESPONSES] | None = None


_BASE: dict[str, Any] = {"impact": paper_impact(), "discretisation": Discretisation()}
_DEFAULTS = {
    name: getattr(type(reduce(getattr, path[1:-1], _BASE[path[0]])), path[-1], MISSING)
    for name, path in ((name, entry.path) for name, entry in PARAMETERS.items())
}
"""Defaults that the model's classes give the fields, or MISSING."""


def _section(*path: str, **fields: Any) -> type[FileSection]:
    """Return the section of a part of the model, with a key per field, from PARAMETERS."""
    keys: dict[str, Any] = {}
    for name, entry in PARAMETERS.items():
        if entry.path[: len(path)] == path:
            key, *deeper = entry.path[len(path) :]
            if key in keys:  # a section below, made for its first parameter
                continue
            optional = not deeper and _DEFAULTS[name] is None
            kind = _section(*path, key) if deeper else value_type(entry)
            about = f"{entry.long_name}, {symbol(entry.units)}".removesuffix(", ")
            about = "" if deeper else about
            keys[key] = (_or_null(kind) if optional else kind, Field(None, description=about))
    return create_model("_".join(path), __base__=FileSection, **(keys | fields))


def _or_null(kind: Any) -> Any:
    """Return the type of a value that may be null, where that is the default."""
    read = WrapValidator(
        lambda value, read: None if value is None else read(value),
        json_schema_input_type=kind | None,
    )
    return Annotated[kind, read]


IMPACT = _section("impact", base=(Annotated[str, one_of("base", BASES)], None))
_SCHEME = Annotated[str, one_of("scheme", (*SCHEMES, "auto"))]
DISCRETISATION = _section("discretisation", auto=(Auto | None, None), scheme=(_SCHEME, None))


def read_impact(data: Any, info: ValidationInfo) -> Impact:
    """Read an impact: a base with changes, or every value. Raises ValueError naming the keys."""
    section: Any = IMPACT.model_validate(data, context=info.context)
    defaults = {} if section.base else _DEFAULTS
    values = {name: defaults[name] for name in defaults if PARAMETERS[name].path[0] == "impact"}
    values |= _given_values(section, "impact")
    if missing := [_key(name) for name, value in values.items() if value is MISSING]:
        raise ValueError(f"without a `base` these are required too: {', '.join(missing)}")
    return _changed((BASES[section.base or "paper"](), Discretisation()), values)[0]


def read_discretisation(data: Any, info: ValidationInfo) -> tuple[Discretisation, Auto | None]:
    """Read a discretisation, and how to find it, if at all. Raises ValueError naming the keys."""
    data = {"auto": {}} if data == "auto" else data
    section: Any = DISCRETISATION.model_validate(data, context=info.context)
    values = _given_values(section, "discretisation")
    for name in values.keys() & {"nodes", "points", "courant"} if section.auto else ():
        raise at_key(name, "cannot be given beside auto, which finds it: take out one of the two")
    return _changed((paper_impact(), Discretisation()), values)[1], section.auto


def _given_values(section: FileSection, root: str) -> dict[str, Any]:
    """Return a section's values by parameter."""
    tree = {root: section.model_dump(exclude_unset=True)}
    values = {}
    for name, entry in PARAMETERS.items():
        node: Any = tree
        for step in entry.path:
            node = node.get(step, MISSING) if isinstance(node, dict) else MISSING
        if node is not MISSING:
            values[name] = node
    return values


def _changed(base: Base, values: Mapping[str, Any]) -> Base:
    if refused := refusal(base, values):
        raise at_key(_key(refused.name), refused.reason)
    return with_values(*base, values)


def _key(name: str) -> str:
    return ".".join(PARAMETERS[name].path[1:])


class Store(FileSection):
    """Data kept of each run beside the responses.

    histories: force and displacements over time, at `samples` times. profiles: strains and
    deflection along the beam at the end.
    """

    histories: StrictBool = False
    profiles: StrictBool = False
    samples: Annotated[Whole, Field(ge=2, le=100_000)] = 1000


class Intervals(FileSection):
    """Settings of intervals: their confidence level, and the number of bootstrap resamples.

    Sobol indices do without resamples.
    """

    confidence: Annotated[Number, Field(ge=0.5, le=0.999)] = 0.95
    resamples: Annotated[Whole, Field(ge=10, le=100_000)] = 200


class Analysis(Intervals):
    """Settings of sensitivity indices.

    failed_runs: what happens to a response that is missing in some runs: no index is given
    ("fail"), or a surrogate fitted to the other runs supplies its values ("impute").
    """

    failed_runs: Annotated[str, one_of("policy", ("fail", "impute"))] = "fail"


_Seconds: Any = quantity("s")


class SlowModel(FileSection):
    """The key `multifidelity`: few runs of a slow model beside many of the study's (docs).

    high: values of the slow model's parameters in place of the study's. pairs: number of its runs,
    and runs of the study's model; 0: the best number. budget: time of one core in s, in place of
    pairs; 0: none. indices: True for Sobol indices, which take further runs of the study's model.
    predict: values of drawn parameters at which the slow model's answers are predicted.
    """

    high: Annotated[dict[StrictStr, Any], Field(min_length=1)]
    pairs: Annotated[Whole, Field(ge=20, le=10_000)] = 40
    runs: Annotated[Whole, Field(ge=0, le=1_000_000)] = 0
    budget: Annotated[_Seconds, Field(ge=0)] = 0.0
    indices: StrictBool = False
    predict: dict[StrictStr, Any] = Field(default_factory=dict)

    def __str__(self) -> str:
        """Return the values of the slow model in words."""
        return ", ".join(f"{name} {value}" for name, value in self.high.items())


def read_limits(data: Any, info: ValidationInfo) -> dict[str, float]:
    """Read limits by response, in SI units; the context has those that the study may have."""
    units: Mapping[str, str] = info.context["responses"]  # type: ignore[index]
    return by_name("Limits", {name: quantity(unit) for name, unit in units.items()}, data, info)


Limits = Annotated[Mapping[str, float], PlainValidator(read_limits)]


class StudyFile(Heading):
    """The keys of a study of impacts; units, choices and defaults come from PARAMETERS."""

    impact: Annotated[Impact, PlainValidator(read_impact)]
    discretisation: Annotated[
        tuple[Discretisation, Auto | None], PlainValidator(read_discretisation)
    ] = Discretisation(), None
    duration: Annotated[float, BeforeValidator(duration), Field(gt=0)]
    sampling: Annotated[Grid | RandomSample, PlainValidator(read_sampling)]
    responses: Annotated[tuple[str, ...], _RESPONSES] = tuple(RESPONSES)
    analyses: Annotated[tuple[str, ...], names("analysis", ANALYSES)] = tuple(ANALYSES)
    limits: Limits = Field(default_factory=dict)
    store: Store = Field(default_factory=Store)
    analysis: Analysis | None = None
    measurements: Names = ()
    multifidelity: SlowModel | None = None


@dataclass(frozen=True)
class Declared:
    """Declarations of a file of any kind.

    name: the file's name without its ending; path: as given. text: the file as it was read.
    """

    name: str
    path: Path
    title: str
    description: str
    text: str

    @property
    def sha256(self) -> str:
        """SHA-256 of the text, in hexadecimal digits."""
        return hashlib.sha256(self.text.encode()).hexdigest()

    def attributes(self) -> dict[str, Any]:
        """Return the attributes by which datasets keep it."""
        attrs = {"study": self.name, "title": self.title, "description": self.description}
        return attrs | {"study_text": self.text, "study_sha256": self.sha256}


@dataclass(frozen=True)
class StudyBase(Declared):
    """The part of a study of runs that does not depend on its solver.

    responses: names of the responses of each run; analyses: names out of ANALYSES. limits: by
    response, in SI units. analysis: settings of sensitivity indices and intervals. multifidelity: a
    slow model to tell of, too.
    """

    sampling: Grid | RandomSample
    responses: tuple[str, ...]
    analyses: tuple[str, ...]
    limits: Mapping[str, float]
    analysis: Analysis
    multifidelity: SlowModel | None = field(default=None, kw_only=True)

    def attributes(self) -> dict[str, Any]:
        """Return the attributes of designs that do not depend on the solver."""
        sampling = self.sampling
        attrs = super().attributes() | {"method": sampling.method, "varied": list(sampling.varied)}
        attrs |= {"responses": list(self.responses), "analyses": list(self.analyses)}
        if not isinstance(sampling, Grid):
            unused = {"resamples"} if isinstance(sampling, Sobol) else None
            attrs |= self.analysis.model_dump(exclude=unused) | sampling.settings
        if self.limits:
            attrs |= {"limited": list(self.limits), "limits": list(self.limits.values())}
        if self.multifidelity:
            attrs |= {"slow_model": str(self.multifidelity)}
        return attrs

    @property
    def size(self) -> str:
        """Describe the amount of work."""
        runs, most = self.sampling.runs, self.sampling.runs_at_most
        until = getattr(self.sampling, "until", None)
        return f"{runs:,} runs" + (f", at most {most:,}" if until else "")


@dataclass(frozen=True)
class ImpactStudy(StudyBase):
    """A study of impacts, in SI units.

    impact and discretisation: the base of all runs. auto: how to find nodes, points and courant
    where they are not given. duration: simulated time in s. responses: names out of SCALARS.
    store: other data kept of each run. measurements: files of measurements to compare with.
    python: keys of the responses that are Python functions.
    """

    impact: Impact
    discretisation: Discretisation
    auto: Auto | None
    duration: float
    store: Store
    measurements: tuple[str, ...] = ()
    python: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class FunctionStudy(StudyBase):
    """A study of a function in place of the solver.

    function: a name out of FUNCTIONS, or the key of a Python function. labels: long_name and units
    of its parameters, by name.
    """

    function: str
    labels: Mapping[str, Mapping[str, str]]

    @property
    def python(self) -> bool:
        """True for a Python function of the user."""
        return "@" in self.function


AnyStudy = ImpactStudy | FunctionStudy


@dataclass(frozen=True)
class Verification(Declared):
    """Checks of the solver to make. checks: names out of verification.catalogue, in file order."""

    checks: tuple[str, ...]

    @property
    def size(self) -> str:
        """Describe the amount of work."""
        return "1 check" if len(self.checks) == 1 else f"{len(self.checks)} checks"
