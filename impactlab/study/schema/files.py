"""Readers of study files: of impacts, of a test function, and of checks."""

from __future__ import annotations

from difflib import get_close_matches
from functools import cache
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, PlainValidator, ValidationError, create_model

from impactlab.model.parameters import Parameter
from impactlab.study.errors import Problem, StudyError, unknown
from impactlab.study.sampling import sampling_reader
from impactlab.study.sampling.grid import Grid
from impactlab.study.sampling.samples import Sobol
from impactlab.study.sampling.sections import Sample
from impactlab.study.schema import checks
from impactlab.study.schema.parameters import Factor
from impactlab.study.schema.section import Heading, names, validation_problems
from impactlab.study.schema.study import Analysis, FunctionStudy, Study, StudyFile, Verification
from impactlab.study.schema.yaml_file import Source, read_mapping, read_source
from impactlab.verification.functions import FUNCTIONS


def read_any(path: str | Path) -> Study | FunctionStudy | Verification:
    """Read a YAML file: a verification if it has the key `checks`, else a study of runs.

    docs/studies.md describes all kinds of files. Raises StudyError with every problem of the file,
    one line each with file, key and value; with the first problem alone where the file is missing,
    is not YAML, or holds no mapping.
    """
    source = read_source(path)
    return _verification(source) if _has(source, "checks") else _runs(source)


def read_study(path: str | Path) -> Study | FunctionStudy:
    """Read a study of runs. Raises StudyError as `read_any`, and for a file of checks."""
    source = read_source(path)
    if _has(source, "checks"):
        raise _wrong_kind(source, "lists checks and has no runs", "verify")
    return _runs(source)


def read_impacts(path: str | Path) -> Study:
    """Read a study of impacts. Raises StudyError as `read_study`, and for a test function."""
    study = read_study(path)
    if isinstance(study, FunctionStudy):
        reason = "is a study of a function, which has no discretisation: use a study of impacts"
        raise StudyError(Problem(str(path), "function", reason, study.function))
    return study


def study_of_text(name: str, text: str) -> Study | FunctionStudy:
    """Read a study of runs from the text of a file NAME.yaml, as datasets keep both.

    Raises StudyError as `read_any`.
    """
    path = Path(f"{name}.yaml")
    return _runs(Source(name, path, text, read_mapping(text, str(path))))


def read_verification(path: str | Path) -> Verification:
    """Read a file of checks. Raises StudyError as `read_any`, and for a study of runs."""
    source = read_source(path)
    if not _has(source, "checks"):
        raise _wrong_kind(source, "has no key checks, so it is a study of runs", "run")
    return _verification(source)


def describe(path: Path) -> dict[str, Any]:
    """Return name, title, size (runs or checks) and traits of a study file, for JSON.

    traits: "checks" (a verification), "auto" (its discretisation is to be found), "sample" (its
    impacts are drawn), "sobol" (by Sobol's sequence), "growing" (until its intervals are narrow),
    "fem3d" (some runs are of the 3-D FE model). Of a file that is wrong: name, no traits, and
    `error`.
    """
    try:
        study = read_any(path)
    except StudyError as error:
        return {"name": path.stem, "traits": [], "error": str(error)}
    sampling, impacts = getattr(study, "sampling", None), isinstance(study, Study)
    traits = {
        "checks": isinstance(study, Verification),
        "growing": isinstance(sampling, Sobol) and bool(sampling.until),
        "auto": isinstance(study, Study) and study.auto is not None,
        "sample": impacts and isinstance(sampling, Sample),
        "sobol": impacts and isinstance(sampling, Sobol),
        "fem3d": isinstance(study, Study) and checks.has_solid_runs(study),
    }
    return {
        "name": study.name,
        "title": study.title,
        "size": study.size,
        "traits": [name for name, has in traits.items() if has],
    }


def _runs(source: Source) -> Study | FunctionStudy:
    return _function_study(source) if _has(source, "function") else _study(source)


def _has(source: Source, key: str) -> bool:
    """Return True if the file has the key, or a misspelling of it."""
    return bool(get_close_matches(key, map(str, source.data), n=1, cutoff=0.75))


def _wrong_kind(source: Source, reason: str, command: str) -> StudyError:
    file = str(source.path)
    return StudyError(Problem(file, "", f"{reason}: use `impactlab {command} {file}`"))


_STAND_INS: dict[str, Any] = {
    "title": "-",
    "impact": {"base": "paper"},
    "duration": 1e-3,
    "sampling": {"method": "grid", "parameters": {"velocity": [1.0]}},
}
"""Values of required sections that are wrong, so that the other sections can be checked."""


def _study(source: Source) -> Study:
    """Return a study of impacts. Raises StudyError with every problem of the file."""
    data, path = source.data, str(source.path)
    keys: dict[int, tuple[str, ...]] = {}
    problems: list[Problem] = []
    try:
        file = StudyFile.model_validate(data, context=keys)
    except ValidationError as error:
        wrong = {line["loc"][0] for line in error.errors(include_url=False)}
        valid = {key: data[key] for key in StudyFile.model_fields if key in data.keys() - wrong}
        file = StudyFile.model_validate(_STAND_INS | valid)
        problems = validation_problems(error, data, path, keys)
    sound = set(StudyFile.model_fields) - {problem.key.split(".")[0] for problem in problems}
    problems += checks.problems(file, path, sound)
    if problems:
        raise StudyError(*problems)
    own: dict[str, Any] = {
        "discretisation": file.discretisation.discretisation,
        "auto": file.discretisation.auto,
        "analysis": file.analysis or Analysis(),
    }
    return Study(name=source.name, path=source.path, text=source.text, **dict(file) | own)


def _function_study(source: Source) -> FunctionStudy:
    """Return a study of a test function. Raises StudyError with every problem of the file."""
    name, path = source.data.get("function"), str(source.path)
    if not isinstance(name, str) or name not in FUNCTIONS:
        raise StudyError(Problem(path, "function", unknown("function", name, FUNCTIONS), name))
    file = _valid(_function_file(name), source)
    own: dict[str, Any] = {"responses": ("value",), "analyses": ("sensitivity", "surrogate")}
    return FunctionStudy(name=source.name, path=source.path, text=source.text, **dict(file) | own)


@cache
def _function_file(name: str) -> type[Heading]:
    """Return the keys of a study of this test function."""
    title = FUNCTIONS[name].title
    factors = {
        key: Factor(Parameter(key, "1", f"{key} of the {title}", ()), lambda value: "")
        for key in FUNCTIONS[name].ranges
    }
    sampling = Annotated[Grid | Sample, PlainValidator(sampling_reader(factors))]
    fields: Any = {
        "function": (str, ...),
        "sampling": (sampling, ...),
        "analysis": (Analysis, Field(default_factory=Analysis)),
    }
    return create_model("FunctionFile", __base__=Heading, **fields)


def _verification(source: Source) -> Verification:
    """Return the checks of a file. Raises StudyError with every problem of the file."""
    from impactlab.verification.catalogue import CATALOGUE  # late: loads all independent solutions

    listed = Annotated[tuple[str, ...], names("check", CATALOGUE)]
    kind = create_model("VerificationFile", __base__=Heading, checks=(listed, ...))
    values = _valid(kind, source).model_dump()
    return Verification(name=source.name, path=source.path, text=source.text, **values)


def _valid(kind: type[Heading], source: Source) -> Any:
    """Validate a whole file. Raises StudyError with every problem."""
    keys: dict[int, tuple[str, ...]] = {}
    try:
        return kind.model_validate(source.data, context=keys)
    except ValidationError as error:
        raise StudyError(*validation_problems(error, source.data, str(source.path), keys)) from None
