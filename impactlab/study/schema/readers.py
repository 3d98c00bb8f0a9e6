"""Readers of study files: of impacts, of a test function, and of checks."""

from collections.abc import Callable, Mapping
from difflib import get_close_matches
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, PlainValidator, create_model

from impactlab.analysis import ANALYSES
from impactlab.methods import read_sampling
from impactlab.methods.grid import Grid
from impactlab.methods.sampling import RandomSample
from impactlab.methods.sobol import Sobol
from impactlab.model.parameters import PARAMETERS, Parameter
from impactlab.model.quantities import si_units
from impactlab.study.schema.consistency import CHECKS, further_models, limit_reasons, values_of
from impactlab.study.schema.declarations import (
    Analysis,
    AnyStudy,
    FunctionStudy,
    ImpactStudy,
    Limits,
    SlowModel,
    StudyFile,
    Verification,
)
from impactlab.study.schema.prediction_points import prediction_points
from impactlab.study.schema.table_file import TableStudy, table_study
from impactlab.study.schema.yaml_file import Source, read_mapping, read_source, text_of
from impactlab.validation.errors import Problem, StudyError, unknown
from impactlab.validation.fields import Heading, Names, names, plain, validated
from impactlab.variables import FLAGS, SCALARS, VARIABLES
from impactlab.verification.functions import FUNCTIONS


def read_any(path: str | Path) -> AnyStudy | TableStudy | Verification:
    """Read a YAML file: a verification if it has the key `checks`, else a study of runs.

    One with the key `table` has its runs already.

    docs/studies.md describes all kinds of files. Raises StudyError with every problem of the file,
    one line each with file, key and value; with the first problem alone where the file is missing,
    is not YAML, or holds no mapping.
    """
    source = read_source(path)
    return _READERS[_kind(source)](source)


def read_study(path: str | Path) -> AnyStudy:
    """Read a study of runs. Raises StudyError as `read_any`, and for a file of any other kind."""
    return _of_runs(read_source(path))


def read_runs(path: str | Path) -> AnyStudy | TableStudy:
    """Read a study of runs or of a table. Raises StudyError as `read_any`, and for checks."""
    study = read_any(path)
    return read_study(path) if isinstance(study, Verification) else study


def read_impacts(path: str | Path) -> ImpactStudy:
    """Read a study of impacts. Raises StudyError as `read_study`, and for a test function."""
    return of_impacts(read_study(path))


def of_impacts(study: AnyStudy) -> ImpactStudy:
    """Return a study of impacts. Raises StudyError for one of a function."""
    if isinstance(study, FunctionStudy):
        reason = "is a study of a function, which has no discretisation: use a study of impacts"
        raise StudyError(Problem(str(study.path), "function", reason, study.function))
    return study


def study_of_text(name: str, text: str) -> AnyStudy:
    """Read a study of runs from the text of NAME.yaml; see `read_any`."""
    path = Path(f"{name}.yaml")
    return _of_runs(Source(name, path, text, read_mapping(text, str(path))))


def study_of_content(name: str, content: dict[str, Any], path: Path) -> AnyStudy:
    """Read a study of runs from the content of NAME.yaml; see `read_any`. path: errors name it."""
    return _of_runs(Source(name, path, text_of(content), content))


def slow_study(study: AnyStudy, high: Mapping[str, Any]) -> AnyStudy:
    """Return the study with other values of parameters, read and checked as its file is.

    study: with its discretisation. Raises StudyError where it cannot have them, ValueError for
    none, or for a parameter that is drawn.
    """
    if not high:
        raise ValueError(
            "multifidelity: high: state what the slow model has in place of the study's, such as "
            "beam_model=solid elements_per_radius=2, or nodes=601"
        )
    content = read_mapping(study.text, str(study.path))
    content.pop("multifidelity", None)
    section = content.get("discretisation")
    if isinstance(study, ImpactStudy) and (section == "auto" or "auto" in (section or ())):
        content["discretisation"] = plain(study.discretisation)
    for name, value in high.items():
        if name in study.sampling.varied:
            raise ValueError(
                f"multifidelity: high: {name} is drawn, and both models have the same draws: "
                "take it out"
            )
        entry = {"distribution": "fixed", "value": plain(value)}
        content["sampling"]["parameters"][name] = entry
    return study_of_content(study.name, content, Path("the slow model"))


def _check_slow_model(study: AnyStudy) -> None:
    """Raise StudyError for a slow model that the study cannot have."""
    if (section := study.multifidelity) is None:
        return
    path, key = str(study.path), "multifidelity"
    if isinstance(study.sampling, Grid):
        reason = (
            "draws from distributions, which a grid has not: use another method, or take it out"
        )
        raise StudyError(Problem(path, key, reason))
    if isinstance(study, FunctionStudy) and not section.runs:
        reason = "must be stated, because what functions cost is not known"
        raise StudyError(Problem(path, f"{key}.runs", reason))
    if section.predict:
        prediction_points(study, section.predict)
    try:
        slow_study(study, section.high)
    except StudyError as error:
        reasons = [f"{problem.key}: {problem.reason}" for problem in error.args]
        raise StudyError(*(Problem(path, f"{key}.high", reason) for reason in reasons)) from None
    except ValueError as error:
        reason = str(error).removeprefix("multifidelity: high: ")
        raise StudyError(Problem(path, f"{key}.high", reason)) from None


def _of_runs(source: Source) -> AnyStudy:
    declared = _READERS[_kind(source)](source)
    if isinstance(declared, Verification):
        raise _wrong_kind(source.path, "lists checks and has no runs", "verify")
    if isinstance(declared, TableStudy):
        raise _wrong_kind(source.path, "has the rows of a table for runs", "go")
    return declared


def read_verification(path: str | Path) -> Verification:
    """Read a file of checks. Raises StudyError as `read_any`, and for a study of runs."""
    source = read_source(path)
    if _kind(source) != "checks":
        raise _wrong_kind(source.path, "has no key checks, so it is a study of runs", "run")
    return _verification(source)


def describe(path: Path) -> dict[str, Any]:
    """Return name, title, size (runs or checks) and traits of a study file, for JSON.

    traits: "checks" (a verification), "table" (runs made elsewhere, in the file `table`), "auto"
    (its discretisation is to be found), "sample" (its impacts are drawn), "sobol" (by Sobol's
    sequence), "growing" (by `until`), "multifidelity" (with a slow model), and those of the wings'
    models that some runs have. measurements: its files of them, if any. Of a file that is wrong:
    name, no traits, and `error`.
    """
    try:
        study = read_any(path)
    except StudyError as error:
        return {"name": path.stem, "traits": [], "error": str(error)}
    sampling, impacts = getattr(study, "sampling", None), isinstance(study, ImpactStudy)
    traits = {
        "checks": isinstance(study, Verification),
        "growing": bool(getattr(sampling, "until", None)),
        "auto": isinstance(study, ImpactStudy) and study.auto is not None,
        "sample": impacts and isinstance(sampling, RandomSample),
        "sobol": impacts and isinstance(sampling, Sobol),
    }
    listed = [name for name, has in traits.items() if has]
    if isinstance(study, ImpactStudy):
        models = further_models(study)
        if study.multifidelity:
            listed += ["multifidelity"]
            models += further_models(of_impacts(slow_study(study, study.multifidelity.high)))
        listed += dict.fromkeys(model.trait for model in models)
    summary = {"name": study.name, "title": study.title, "size": study.size, "traits": listed}
    if isinstance(study, TableStudy):
        return summary | {"traits": ["table"], "table": str(study.csv)}
    measured = list(getattr(study, "measurements", ()))
    return summary | ({"measurements": measured} if measured else {})


def _kind(source: Source) -> str:
    """Return the key that the file has, perhaps misspelt, and that tells its kind; else ""."""
    keys = [str(key) for key in source.data]
    return next(key for key in _READERS if not key or get_close_matches(key, keys, 1, 0.75))


def _wrong_kind(file: Path, reason: str, command: str) -> StudyError:
    return StudyError(Problem(str(file), "", f"{reason}: use `impactlab {command} {file}`"))


_STAND_INS: dict[str, Any] = {
    "title": "-",
    "impact": {"base": "paper"},
    "duration": 1e-3,
    "sampling": {"method": "grid", "parameters": {"velocity": [1.0]}},
}
"""Values of required sections that are wrong, so that the other sections can be checked."""


def _study(source: Source) -> ImpactStudy:
    path, data = str(source.path), dict(source.data)
    python, units = _python_responses(data.pop("python_responses", {}), path)
    units = {name: response.units for name, response in SCALARS.items()} | units
    problems: list[Problem] = []
    try:
        file = validated(StudyFile, data, path, responses=units)
    except StudyError as error:
        problems = list(error.args)
    wrong = {problem.key.split(".")[0] for problem in problems}
    if problems:
        valid = {key: data[key] for key in StudyFile.model_fields if key in data.keys() - wrong}
        file = validated(StudyFile, _STAND_INS | valid, path, responses=units)
    for check, sections in CHECKS:
        if not sections & wrong:
            problems += [Problem(path, key, reason) for key, reason in check(file)]
    if problems:
        raise StudyError(*problems)
    grid, auto = file.discretisation
    models = values_of(file.sampling, "beam_model", file.impact.beam_model)
    grid = grid.resolved(map(str, models))
    if python and (further := further_models(file)):
        reason = f"are given beam runs, which those with beam_model: {further[0].name} are not"
        raise StudyError(Problem(path, "python_responses", reason))
    fields: dict[str, Any] = dict(file) | {"discretisation": grid, "auto": auto, "python": python}
    fields["analysis"] = file.analysis or Analysis()
    study = ImpactStudy(name=source.name, path=source.path, text=source.text, **fields)
    _check_slow_model(study)
    return study


def _python_responses(responses: Any, path: str) -> tuple[dict[str, str], dict[str, str]]:
    """Return keys and units of the responses that are Python functions, known in this process."""
    if responses == {}:
        return {}, {}
    from impactlab.study.solvers.own import KNOWN

    if not isinstance(responses, dict) or not {*map(str, responses.values())} <= KNOWN.keys():
        raise StudyError(Problem(path, "python_responses", _NOT_KNOWN))
    keys = {str(name): str(key) for name, key in responses.items()}
    variables = {*PARAMETERS, *VARIABLES, *FLAGS}
    for name in keys:
        if not name.isidentifier() or name in variables:
            why = "another variable has it" if name in variables else "use letters, digits and _"
            reason = f"cannot name a response: {why}"
            raise StudyError(Problem(path, f"responses.{name}", reason))
    return keys, {name: KNOWN[key].unit(name) for name, key in keys.items()}


_NOT_KNOWN = "holds a Python function, which is in no file: build the study in Python"


def _function_study(source: Source) -> FunctionStudy:
    name, path = source.data.get("function"), str(source.path)
    kind: type[FunctionFile]
    if isinstance(name, str) and "@" in name:
        kind, (parameters, responses) = _PythonFunctionFile, _python_function(source, name)
    elif isinstance(name, str) and name in FUNCTIONS:
        kind, responses = FunctionFile, {"value": "1"}
        parameters = {key: Parameter(key, "1", key, ()) for key in FUNCTIONS[name].ranges}
    else:
        raise StudyError(Problem(path, "function", unknown("function", name, FUNCTIONS), name))
    file = validated(kind, source.data, path, parameters, responses)
    reason = file.sampling.no_surrogate if kind is _PythonFunctionFile else ""
    if reason and file.analysis.failed_runs == "impute":
        raise StudyError(Problem(path, "analysis.failed_runs", f"{reason}: set failed_runs: fail"))
    labels = {
        key: {"long_name": parameter.long_name, "units": parameter.units}
        for key, parameter in parameters.items()
    }
    fields: dict[str, Any] = {"responses": tuple(responses)} | dict(file) | {"labels": labels}
    fields["analyses"] = tuple(ANALYSES)
    study = FunctionStudy(name=source.name, path=source.path, text=source.text, **fields)
    if problems := [Problem(path, *reason) for reason in limit_reasons(study)]:
        raise StudyError(*problems)
    _check_slow_model(study)
    return study


def _python_function(source: Source, key: str) -> tuple[dict[str, Parameter], dict[str, str]]:
    """Return the parameters of a Python function, and its responses with their units."""
    from impactlab.study.solvers.own import KNOWN

    path = str(source.path)
    if key not in KNOWN:
        raise StudyError(Problem(path, "function", _NOT_KNOWN))
    sampling = source.data.get("sampling")
    listed = sampling.get("parameters") if isinstance(sampling, dict) else None
    entries = (
        {str(name): entry for name, entry in listed.items()} if isinstance(listed, dict) else {}
    )
    names = source.data.get("responses")
    responses = [str(name) for name in names] if isinstance(names, list) else ["value"]
    places = [(name, f"sampling.parameters.{name}") for name in entries]
    places += [(name, f"responses.{index}") for index, name in enumerate(responses)]
    for name, place in places:
        if reason := _name_problem(name) or (
            name in entries and name in responses and "names a parameter and a response"
        ):
            raise StudyError(Problem(path, place, f"{reason}: choose another name", name))
    parameters = {
        name: Parameter(name, _units(entry), name.replace("_", " "), (), any_word=True)
        for name, entry in entries.items()
    }
    return parameters, {name: KNOWN[key].unit(name) for name in responses}


_TAKEN = ("run", "response", "parameter", *FLAGS)
"""Names of dimensions and variables of every study's datasets."""


def _name_problem(name: str) -> str:
    """Return why a Python function's parameter or response cannot have a name; "" if it can."""
    if not name.isidentifier():
        return "cannot name an argument of a function, which has letters, digits and _"
    return "is the name of another variable of the results" if name in _TAKEN else ""


def _units(entry: Any) -> str:
    """Return the SI units of a parameter by the first of its values that states one."""
    values = [*entry.values()] if isinstance(entry, dict) else entry
    stated = map(si_units, values) if isinstance(values, list) else ()
    return next((units for units in stated if units != "1"), "1")


class FunctionFile(Heading):
    """The keys of a study of a test function."""

    function: str
    sampling: Annotated[Grid | RandomSample, PlainValidator(read_sampling)]
    limits: Limits = Field(default_factory=dict)
    analysis: Analysis = Field(default_factory=Analysis)
    multifidelity: SlowModel | None = None


class _PythonFunctionFile(FunctionFile):
    responses: Names = ("value",)


def verification_file() -> type[Heading]:
    """Return the section that a file of checks is."""
    from impactlab.verification.catalogue import CATALOGUE  # late: loads all independent solutions

    listed = Annotated[tuple[str, ...], names("check", CATALOGUE)]
    return create_model("VerificationFile", __base__=Heading, checks=(listed, ...))


def _verification(source: Source) -> Verification:
    values = validated(verification_file(), source.data, str(source.path)).model_dump()
    return Verification(name=source.name, path=source.path, text=source.text, **values)


_READERS: dict[str, Callable[[Source], AnyStudy | TableStudy | Verification]] = {
    "checks": _verification,
    "table": table_study,
    "function": _function_study,
    "": _study,
}
"""Readers of files, by the key that tells their kind."""
