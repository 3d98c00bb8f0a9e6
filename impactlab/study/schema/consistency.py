"""Checks between the sections of a study of impacts."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from impactlab import wings
from impactlab.analysis import ANALYSES
from impactlab.methods import NO_DISTRIBUTION
from impactlab.methods.distributions import Choice, Steps
from impactlab.methods.entries import Distribution
from impactlab.methods.grid import Grid
from impactlab.methods.hypercube import Hypercube
from impactlab.methods.sampling import RandomSample, Sampling
from impactlab.methods.sobol import Sobol
from impactlab.model import impact
from impactlab.model.bodies import sphere_rows
from impactlab.model.case_table import (
    MODAL_DAMPING,
    MODAL_PATCH,
    NO_INTERVAL,
    TOO_SOON,
    between_nodes,
)
from impactlab.model.contact_compliance import TIMOSHENKO_ALONE, TIMOSHENKO_OPTIONS
from impactlab.model.parameters import PARAMETERS, SECTION, Value
from impactlab.model.plausibility import Extremes, implausibilities, numbers
from impactlab.model.quantities import shown
from impactlab.solver import BEAM_MODELS, BENDING_MODELS, LUMPED_MODELS, RAYLEIGH, WAVE_MODELS
from impactlab.solver.outputs import GROWING
from impactlab.study.schema.declarations import FunctionStudy, ImpactStudy, StudyFile
from impactlab.validation.errors import unknown
from impactlab.validation.refusals import Base, refused_corner

Reasons = Iterator[tuple[str, str]]
"""Dotted keys, and the reason why each is wrong."""

_MESH = ("nodes", "points", "rule", "beam_span", "beam_depth", *SECTION)
"""Parameters that move the places at which profiles are given."""
_MANY = 1000  # values that are no longer checked one by one
_TAILS = np.array([1e-3, 1 - 1e-3])


def further_models(study: ImpactStudy | StudyFile) -> list[wings.FurtherModel]:
    """Return the models of wings that some of the runs have."""
    return wings.among(values_of(study.sampling, "beam_model", study.impact.beam_model))


def values_of(sampling: Grid | RandomSample, name: str, base: Value) -> tuple[Value, ...]:
    """Return all values that sampling lists or steps through, or else the base's.

    Of very many steps those at both ends.
    """
    entry = sampling.parameters.get(name)
    values: tuple[Value, ...] = (sampling.fixed.get(name, base),)
    if isinstance(sampling, Grid) and entry is not None:
        values = entry
    elif isinstance(entry, Choice):
        values = tuple(entry.values)
    elif isinstance(entry, Steps):
        last = entry.count - 1
        steps = np.arange(last + 1) if last < _MANY else np.array([0, last])
        values = tuple(entry.at_steps(steps).tolist())
    return values


def extremes(base: Base, sampling: Sampling) -> Extremes:
    """Return the least and greatest values of base and varied parameters.

    A tail ends at its last thousandth; one that reaches below zero is left to the check of draws.
    """
    ends: dict[str, Any] = numbers(*base)
    for name, values in sampling.bounds().items():
        if not isinstance(values[0], str):
            ends[name] = min(values), max(values)
    for name, entry in sampling.varied.items():
        if isinstance(entry, Distribution) and not entry.bounds():
            low, high = entry.quantile(_TAILS).tolist()
            ends[name] = (low, high) if low > 0 else ends.get(name, (high, high))
    return ends


def key_of(name: str, sampling: Sampling) -> str:
    """Return the key of a parameter in the study, whether it is given or not."""
    varied = name in sampling.parameters
    return f"sampling.parameters.{name}" if varied else ".".join(PARAMETERS[name].path)


def _mass_and_density(file: StudyFile) -> Reasons:
    """Density and radius have no effect beside a stated mass."""
    varied, mass = file.sampling.parameters, file.impact.sphere.mass
    for name in ("sphere_radius", "sphere_density"):
        if name in varied and mass is not None and "sphere_mass" not in varied:
            reason = (
                f"has no effect on the stated mass of the sphere ({mass!r} kg): set "
                "impact.sphere.mass: null to let it follow from density and radius"
            )
            yield f"sampling.parameters.{name}", reason
    if {"sphere_mass", "sphere_density"} <= varied.keys():
        reason = "has no effect beside sphere_mass: take out one of the two"
        yield "sampling.parameters.sphere_density", reason


def _one_mesh_for_profiles(file: StudyFile) -> Reasons:
    """Profiles of all runs share their x and z."""
    reason = (
        "cannot be varied with store.profiles: true, because the places x and z of the profiles "
        "would differ between runs: set profiles: false, or fix it"
    )
    width = () if file.impact.beam.shape == "rectangle" else ("beam_width",)
    for name in (*_MESH, *width) if file.store.profiles else ():
        if name in file.sampling.varied:
            yield f"sampling.parameters.{name}", reason


def _runs_for_the_analyses(file: StudyFile) -> Reasons:
    """Each analysis that is listed by name has the runs that it needs, settings have a sample."""
    if file.analysis is not None and isinstance(file.sampling, Grid):
        yield "analysis", "has no effect with method: grid: take it out"
    grid = file.sampling.parameters if isinstance(file.sampling, Grid) else {}
    counts = {name: len(values) for name, values in grid.items()}
    plan = file.sampling.method, counts, file.store.histories
    for name in file.analyses if file.analyses != tuple(ANALYSES) else ():
        if not ANALYSES[name].possible(*plan):
            needs = ANALYSES[name].needs
            yield "analyses", f"{name} needs {needs}: take it out, or change the sampling"
        elif name == "surrogate" and (reason := file.sampling.no_surrogate):
            yield "analyses", f"{reason}: take out surrogate"
    imputed = file.analysis is not None and file.analysis.failed_runs == "impute"
    if imputed and (reason := file.sampling.no_surrogate):
        yield "analysis.failed_runs", f"{reason}: set failed_runs: fail"


def _strikes_for_the_responses(file: StudyFile) -> Reasons:
    """Check that responses of several strikes have several, and that none is made up."""
    listed = [name for name in GROWING if name in file.responses]
    most = max(map(int, values_of(file.sampling, "strikes", file.impact.strikes)))
    if listed and most == 1:
        reason = "needs several strikes: vary strikes, set impact.strikes, or leave it out"
        yield "responses", f"{listed[0]} {reason}"
    if listed and file.analysis is not None and file.analysis.failed_runs == "impute":
        reason = (
            f"a run without {listed[0]} has it beyond its last strike, and a surrogate of the "
            "other runs would not know: set failed_runs: fail"
        )
        yield "analysis.failed_runs", reason


def limit_reasons(file: StudyFile | FunctionStudy) -> Reasons:
    """Check that limits are of responses, with runs that tell the probability to exceed them."""
    for name in file.limits:
        if name not in file.responses:
            yield f"limits.{name}", unknown("response", name, file.responses)
    method = file.sampling.method
    for indices in getattr(file.sampling, "estimates", ()):
        if indices.of_limits and not file.limits:
            key = "indices" if method == "latin" else "method"
            yield f"sampling.{key}", f"{indices.name} needs `limits`: state that of a response"
    if file.limits and (reason := NO_DISTRIBUTION.get(method)):
        methods = "sobol or a Latin hypercube (latin, delta, hsic, ...)"
        yield "limits", f"give no probabilities with method {method}: {reason} (use {methods})"
    elif file.limits and "distribution" not in file.analyses:
        yield "limits", "need the analysis distribution: list it in analyses"
    if isinstance(file.sampling, Hypercube) and file.sampling.until:
        from impactlab.analysis.limit_state import MOST_PARAMETERS  # late: others do without

        if len(file.limits) != 1:
            reason = "places runs about the limit of one response: state that one in `limits`"
            yield "sampling.until", reason
        if len(file.sampling.varied) > MOST_PARAMETERS:
            reason = f"is for {MOST_PARAMETERS} varied parameters at most: leave it out"
            yield "sampling.until", reason


def _automatic_discretisation(file: StudyFile) -> Reasons:
    """Check that an automatic discretisation is not varied, and its responses are the study's."""
    _, auto = file.discretisation
    for name in ("nodes", "points", "courant") if auto else ():
        if name in file.sampling.parameters:
            reason = "cannot be varied beside discretisation: auto, which finds it"
            yield f"sampling.parameters.{name}", reason
    if missing := set(auto.responses or () if auto else ()) - set(file.responses):
        reason = f"names {', '.join(sorted(missing))}, which `responses` of the study leaves out"
        yield "discretisation.auto.responses", reason


def _indices_to_grow_by(file: StudyFile) -> Reasons:
    """Check that a growing sample has the indices that decide when it stops."""
    until = file.sampling.until if isinstance(file.sampling, Sobol) else None
    if until is None:
        return
    if "sensitivity" not in file.analyses:
        yield "sampling.until", "needs the analysis sensitivity: list it in analyses"
    for index, name in enumerate(until.responses or ()):
        if name not in file.responses:
            yield f"sampling.until.responses.{index}", unknown("response", name, file.responses)


def _impacts(file: StudyFile) -> Reasons:
    """Check that no corner of varied values is refused or impossible, and that schemes fit."""
    grid, sampling = file.discretisation[0], file.sampling
    varied = sampling.bounds()
    if refused := refused_corner((file.impact, grid), varied):
        name = refused.name if refused.name in varied else next(iter(refused.values))
        values = ", ".join(
            shown(key, value, PARAMETERS[key].units) for key, value in refused.values.items()
        )
        yield f"sampling.parameters.{name}", f"{values}: {refused.name} {refused.reason}"
    ends = extremes((file.impact, grid), sampling)
    for problem in implausibilities(ends):
        if problem.impossible:
            yield key_of(problem.name, sampling), problem.reason
    models = values_of(sampling, "beam_model", file.impact.beam_model)
    no_bending = [name for name in BEAM_MODELS if name in models and name not in BENDING_MODELS]
    schemes = {*values_of(sampling, "scheme", grid.scheme)} - {"leapfrog", "auto"}
    if no_bending and schemes:
        reason = (
            f"{min(map(str, schemes))} is for {' and '.join(BENDING_MODELS)}, and {no_bending[0]} "
            "has leapfrog alone: set scheme: leapfrog, or take out the beam model"
        )
        yield key_of("scheme", sampling), reason
    yield from _other_beams(file, set(models))
    yield from _resisted_beams(file, ends)
    yield from _several_strikes(file, ends)
    lumped = [name for name in LUMPED_MODELS if name in models]
    if lumped and "contact_patch" in values_of(sampling, "load", file.impact.load):
        reason = f"contact_patch is not for {lumped[0]}, which moves as one mass: set load: point"
        yield key_of("load", sampling), f"{reason}, or take out the beam model"
    for name, plain in TIMOSHENKO_OPTIONS.items():
        options = values_of(sampling, name, getattr(file.impact, name))
        ours = sorted(set(map(str, options)) - {plain})
        if ours and set(models) - {"timoshenko", *wings.models()}:
            yield key_of(name, sampling), f"{ours[0]} {TIMOSHENKO_ALONE}"


def _other_beams(file: StudyFile, models: set[Value]) -> Reasons:
    """Check that other ends and places have a model, and that a node is struck."""
    sampling, beam, grid = file.sampling, file.impact.beam, file.discretisation[0]
    places = values_of(sampling, "strike_position", file.impact.strike_position)
    key = key_of("strike_position", sampling)
    entry = sampling.varied.get("strike_position")
    if isinstance(entry, Distribution) and not entry.is_discrete:
        yield key, "must lie on a node: write {distribution: steps, low: ..., high: ..., step: ...}"
        return
    for place in map(float, places):
        for nodes in map(int, values_of(sampling, "nodes", grid.nodes)):
            if reason := between_nodes(place, nodes):
                yield key, f"{place:g} {reason}"
                return
    if file.discretisation[1] is not None and set(places) != {impact.MID_SPAN}:
        yield "discretisation.auto", "needs strike_position: 0.5: state the discretisation"
    supports = {
        support
        for side in ("left", "right")
        for support in values_of(sampling, f"support_{side}", getattr(beam, f"support_{side}"))
    }
    if supports <= set(impact.HINGES) and set(places) == {impact.MID_SPAN}:
        return
    if models - set(impact.MOVING_MODELS):
        reason = f"must be {' or '.join(impact.MOVING_MODELS)} {impact.OTHER_BEAM}"
        yield key_of("beam_model", sampling), reason
    elif "elastic" in supports and models - set(impact.MODELS_ON_SPRINGS):
        yield key_of("beam_model", sampling), f"must be {impact.SPRUNG_BEAM}"


def _resisted_beams(file: StudyFile, ends: Extremes) -> Reasons:
    """Check that what resists the motion of a beam has a model and a scheme."""
    sampling, grid = file.sampling, file.discretisation[0]
    models = set(values_of(sampling, "beam_model", file.impact.beam_model))
    damped = any(ends[name][1] > 0.0 for name in RAYLEIGH)
    if damped and models - set(impact.MODELS_ON_SPRINGS):
        yield key_of("beam_model", sampling), f"must be {impact.DAMPED_BEAM}"
    if ends["damping_ratio"][1] > 0.0 and models - set(WAVE_MODELS):
        yield key_of("beam_model", sampling), f"must be {impact.RATIO_DAMPED_BEAM}"
    if ends["foundation_stiffness"][1] > 0.0 and models - set(impact.MODELS_ON_SPRINGS):
        yield key_of("beam_model", sampling), f"must be {impact.FOUNDED_BEAM}"
    schemes = values_of(sampling, "scheme", grid.scheme)
    if ends["damping_ratio"][1] > 0.0 and "leapfrog" in schemes:
        yield key_of("damping_ratio", sampling), MODAL_DAMPING


def _several_strikes(file: StudyFile, ends: Extremes) -> Reasons:
    """Check that strikes wait for those before, and that further spheres have nodes."""
    sampling, grid = file.sampling, file.discretisation[0]
    interval = ends.get("strike_interval", (file.duration,))[0]
    if ends["strikes"][1] == 1 and "strike_interval" in ends:
        yield key_of("strike_interval", sampling), NO_INTERVAL
    elif interval < file.duration:
        value = shown("strike_interval", interval, "s")
        yield key_of("strike_interval", sampling), f"{value} {TOO_SOON}"
    spheres, key = sphere_rows(file.impact.further_spheres or ()), "impact.further_spheres"
    if spheres and file.discretisation[1] is not None:
        yield "discretisation.auto", "needs one sphere: state the discretisation"
        return
    loads = values_of(sampling, "load", file.impact.load)
    if (
        spheres
        and "contact_patch" in loads
        and "modal" in values_of(sampling, "scheme", grid.scheme)
    ):
        yield key_of("load", sampling), MODAL_PATCH
        return
    for place, _, _ in spheres:
        for nodes in map(int, values_of(sampling, "nodes", grid.nodes)):
            if reason := between_nodes(place, nodes):
                yield key, f"{place:g} {reason}"
                return


def _further_models(file: StudyFile) -> Reasons:
    """Check runs of a wing's model as the wing does; without any, its sizes have no effect."""
    for model in wings.models().values():
        if model in further_models(file):
            yield from model.part("checks")(file)
            continue
        for key in size_keys(file, model):
            yield key, f"has no effect without beam_model: {model.name}: take it out"


def size_keys(file: StudyFile, model: wings.FurtherModel) -> list[str]:
    """Return the keys of the sizes of a wing's model that the file states."""
    varied, grid = file.sampling.parameters, file.discretisation[0]
    names = (size.name for size in model.sizes)
    stated = (name for name in names if name in varied or getattr(grid, name) is not None)
    return [key_of(name, file.sampling) for name in stated]


CHECKS: tuple[tuple[Callable[[StudyFile], Reasons], set[str]], ...] = (
    (_mass_and_density, {"impact", "sampling"}),
    (_one_mesh_for_profiles, {"store", "sampling"}),
    (_runs_for_the_analyses, {"analyses", "analysis", "sampling", "store"}),
    (_strikes_for_the_responses, {"analysis", "impact", "responses", "sampling"}),
    (limit_reasons, {"limits", "responses", "analyses", "sampling"}),
    (_automatic_discretisation, {"discretisation", "responses", "sampling"}),
    (_indices_to_grow_by, {"analyses", "responses", "sampling"}),
    (_impacts, {"impact", "discretisation", "sampling", "duration"}),
    (_further_models, {"impact", "discretisation", "sampling", "responses", "store"}),
)
"""The checks, and the sections that each reads: without errors of their own, or it is left out."""
