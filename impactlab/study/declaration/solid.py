"""What a study must and must not say where some of its runs are of the 3-D model."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from impactlab.model.impact import SOLID
from impactlab.study.declaration.methods import Grid

if TYPE_CHECKING:
    from impactlab.study.declaration.schema import StudyForm
    from impactlab.study.declaration.study import Study

_KEY, _SIZE = "beam_model", "element_size"
_UNKNOWN = "contact_dissipation"
"""The one response that the 3-D model does not tell from another."""


def asks_for_solid(study: Study | StudyForm) -> bool:
    """Whether any run is of the 3-D model."""
    sampling = study.sampling
    listed = sampling.parameters if isinstance(sampling, Grid) else sampling.fixed
    models = listed.get(_KEY, study.impact.beam_model)
    return SOLID in (models if isinstance(models, tuple) else (models,))


def solid_problems(form: StudyForm) -> Iterator[tuple[str, str]]:
    """Dotted keys, and what is wrong there."""
    varied = _SIZE in form.sampling.parameters
    stated = form.discretisation.discretisation.element_size is not None
    if not asks_for_solid(form):
        if varied or stated:
            key = f"sampling.parameters.{_SIZE}" if varied else f"discretisation.{_SIZE}"
            yield key, f"has no effect without beam_model: {SOLID}: take it out"
        return
    if not isinstance(form.sampling, Grid):
        yield "sampling.method", f"beam_model: {SOLID} is for method: grid (a run takes minutes)"
    if not (varied or stated):
        reason = f"is required for beam_model: {SOLID} (1 mm takes seconds a run, 0.5 mm a minute)"
        yield f"discretisation.{_SIZE}", reason
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
