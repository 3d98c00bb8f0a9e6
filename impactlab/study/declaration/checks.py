"""What must hold between the sections of a study file."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from impactlab.model.parameters import ELEMENTS, Value, flatten
from impactlab.solver import BEAM_MODELS
from impactlab.study.declaration.methods import Grid, Sample, Sobol
from impactlab.study.declaration.plausible import doubts, ends_of, stated_at
from impactlab.study.declaration.schema import StudyForm
from impactlab.study.declaration.solid import solid_problems
from impactlab.study.errors import Problem, unknown
from impactlab.study.validity import refused_corner
from impactlab.variables import ANALYSES

_MESH = ("nodes", "points", "rule", "beam_span", "beam_depth")
"""Parameters that move the places at which profiles are given."""


_FIBRES = ("euler_bernoulli", "elastic")
"""Models of the beam that have both schemes in time."""


def problems(form: StudyForm, file: str, sound: set[str]) -> list[Problem]:
    """What contradicts what; a check is left out where a section that it reads is not sound."""
    return [
        Problem(file, key, reason)
        for check, sections in _CHECKS
        if sections <= sound
        for key, reason in check(form)
    ]


Findings = Iterator[tuple[str, str]]
"""Dotted keys, and what is wrong there."""


def _mass_and_density(form: StudyForm) -> Findings:
    """A stated mass leaves no part to what it would follow from."""
    varied = form.sampling.parameters
    for name in ("sphere_radius", "sphere_density"):
        if name in varied and form.impact.sphere.mass is not None and "sphere_mass" not in varied:
            yield (
                f"sampling.parameters.{name}",
                f"the stated mass of the sphere ({form.impact.sphere.mass!r} kg) would stay as it "
                "is: set impact.sphere.mass: null to let it follow from density and radius",
            )
    if {"sphere_mass", "sphere_density"} <= varied.keys():
        reason = "has no effect where sphere_mass is stated too: take out one of the two"
        yield "sampling.parameters.sphere_density", reason


def _one_mesh_for_profiles(form: StudyForm) -> Findings:
    """Profiles of all runs share their x and z."""
    for name in _MESH:
        if form.store.profiles and name in form.sampling.varied:
            yield (
                f"sampling.parameters.{name}",
                "cannot be varied with store.profiles: true, because the places x and z of the "
                "profiles would differ between runs: set profiles: false, or fix it",
            )


def _analysis_of_a_sample(form: StudyForm) -> Findings:
    """Nothing stated goes without effect."""
    if form.analysis is not None and not isinstance(form.sampling, Sample):
        yield "analysis", "has no effect with method: grid: take it out"


def _runs_for_the_analyses(form: StudyForm) -> Findings:
    """Each analysis that is asked for by name can be made."""
    grid = form.sampling.parameters if isinstance(form.sampling, Grid) else {}
    counts = {name: len(values) for name, values in grid.items()}
    possible = {
        "convergence_in_nodes": counts.get("nodes", 0) >= 3,
        "convergence_in_time_step": counts.get("courant", 0) >= 3,
        "convergence_in_element_size": any(counts.get(name, 0) >= 3 for name in ELEMENTS),
        "convergence_in_points": counts.get("points", 0) >= 2,
        "sensitivity": not grid,
        "surrogate": not grid,
    }
    for name in form.analyses if form.analyses != tuple(ANALYSES) else ():
        if not possible[name]:
            yield "analyses", f"{name} needs {ANALYSES[name]}: take it out, or change the sampling"


def _nothing_to_find(form: StudyForm) -> Findings:
    """What is varied is not sought; what the trials are judged by is there."""
    auto = form.discretisation.auto
    for name in ("nodes", "points", "courant") if auto else ():
        if name in form.sampling.parameters:
            reason = "cannot be varied beside discretisation: auto, which finds it"
            yield f"sampling.parameters.{name}", reason
    missing = set(auto.responses or () if auto else ()) - set(form.responses)
    if missing:
        reason = f"names {', '.join(sorted(missing))}, which `responses` of the study leaves out"
        yield "discretisation.auto.responses", reason


def _answers_to_grow_by(form: StudyForm) -> Findings:
    """A sample that grows until its indices are good enough has these indices."""
    until = form.sampling.until if isinstance(form.sampling, Sobol) else None
    if until is None:
        return
    if "sensitivity" not in form.analyses:
        yield "sampling.until", "needs the analysis sensitivity: list it in analyses"
    for at, name in enumerate(until.responses or ()):
        if name not in form.responses:
            yield f"sampling.until.responses.{at}", unknown("response", name, form.responses)


def _corners(form: StudyForm) -> Findings:
    """The model accepts all combinations of what is varied."""
    varied = form.sampling.bounds()
    if found := refused_corner((form.impact, form.discretisation.discretisation), varied):
        name = found.name if found.name in varied else next(iter(found.values))
        values = ", ".join(f"{key} = {value!r}" for key, value in found.values.items())
        yield f"sampling.parameters.{name}", f"{values}: {found.name} {found.reason}"


def _physics(form: StudyForm) -> Findings:
    """No impact is beyond what sphere and beam can be."""
    base = form.impact, form.discretisation.discretisation
    for doubt in doubts(ends_of(base, form.sampling)):
        if doubt.impossible:
            yield stated_at(doubt.name, form.sampling), doubt.reason


def _scheme_of_the_model(form: StudyForm) -> Findings:
    """Each model of the beam is asked for a scheme that it has."""
    base = flatten(form.impact, form.discretisation.discretisation)
    given: dict[str, tuple[Value, ...]] = {name: (base[name],) for name in ("scheme", "beam_model")}
    given |= {name: words for name, words in _words(form.sampling).items() if name in given}
    others = [name for name in BEAM_MODELS if name in given["beam_model"] and name not in _FIBRES]
    if others and "semi_implicit" in given["scheme"]:
        reason = f"semi_implicit is for {' and '.join(_FIBRES)}: {others[0]} has leapfrog alone"
        yield stated_at("scheme", form.sampling), reason


def _words(sampling: Grid | Sample) -> dict[str, tuple[Value, ...]]:
    """All values that parameters have, of those that a sample cannot draw."""
    if isinstance(sampling, Sample):
        return {name: (value,) for name, value in sampling.fixed.items()}
    return dict(sampling.parameters)


_CHECKS: tuple[tuple[Callable[[StudyForm], Findings], set[str]], ...] = (
    (_mass_and_density, {"impact", "sampling"}),
    (_one_mesh_for_profiles, {"store", "sampling"}),
    (_analysis_of_a_sample, {"analysis", "sampling"}),
    (_runs_for_the_analyses, {"analyses", "sampling"}),
    (_nothing_to_find, {"discretisation", "responses", "sampling"}),
    (_answers_to_grow_by, {"analyses", "responses", "sampling"}),
    (_corners, {"impact", "discretisation", "sampling"}),
    (_physics, {"impact", "discretisation", "sampling"}),
    (_scheme_of_the_model, {"impact", "discretisation", "sampling"}),
    (solid_problems, {"impact", "discretisation", "sampling", "responses", "store"}),
)
