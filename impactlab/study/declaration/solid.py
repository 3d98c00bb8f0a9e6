"""What a study must and must not say where some of its runs are of the 3-D model."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from impactlab.model.impact import SOLID
from impactlab.model.parameters import ELEMENTS
from impactlab.study.declaration.methods import Grid

if TYPE_CHECKING:
    from impactlab.study.declaration.schema import StudyForm
    from impactlab.study.declaration.study import Study

_KEY = "beam_model"
_UNKNOWN = "contact_dissipation"
"""The one response that the 3-D model does not tell from another."""


def asks_for_solid(study: Study | StudyForm) -> bool:
    """Whether any run is of the 3-D model."""
    sampling = study.sampling
    listed = sampling.parameters if isinstance(sampling, Grid) else sampling.fixed
    models = listed.get(_KEY, study.impact.beam_model)
    return SOLID in (models if isinstance(models, tuple) else (models,))


def _stated(form: StudyForm) -> Iterator[str]:
    """Keys that tell the size of the solid elements."""
    for name in ELEMENTS:
        if name in form.sampling.parameters:
            yield f"sampling.parameters.{name}"
        elif getattr(form.discretisation.discretisation, name) is not None:
            yield f"discretisation.{name}"


def _size_problems(stated: list[str], solid: bool) -> Iterator[tuple[str, str]]:
    """The 3-D model takes one size of its elements, the others none. stated: keys."""
    if not solid:
        for key in stated:
            yield key, f"has no effect without beam_model: {SOLID}: take it out"
    elif not stated:
        reason = f"is required for beam_model: {SOLID} (1 mm takes seconds a run, 0.5 mm a minute)"
        yield f"discretisation.{ELEMENTS[0]}", reason
    for key in stated[1:] if solid else []:
        yield key, f"{stated[0]} says it already: take one of them out"


def solid_problems(form: StudyForm) -> Iterator[tuple[str, str]]:
    """Dotted keys, and what is wrong there."""
    yield from _size_problems(list(_stated(form)), asks_for_solid(form))
    if not asks_for_solid(form):
        return
    if not isinstance(form.sampling, Grid):
        yield "sampling.method", f"beam_model: {SOLID} is for method: grid (a run takes minutes)"
    if form.discretisation.auto is not None:
        yield "discretisation.auto", f"is not for beam_model: {SOLID}: state the discretisation"
    if form.store.profiles:
        yield "store.profiles", f"must be false with beam_model: {SOLID}, which has no profiles"
    if _UNKNOWN in form.responses:
        reason = (
            f"{_UNKNOWN} is not known of beam_model: {SOLID}, whose plastic_dissipation holds that "
            "of the contact: list the responses without it"
        )
        yield "responses", reason
