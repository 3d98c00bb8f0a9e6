"""Rules of a study with runs of the 3-D FE model: what they require, and how they converge."""

from impactlab.analysis.convergence.axes import Axis, Growth
from impactlab.fem3d.wing import MODEL, SIZES, SOLID
from impactlab.solver import outputs
from impactlab.study.schema.consistency import Reasons, size_keys
from impactlab.study.schema.declarations import StudyFile

ELEMENT_SIZE = Axis(
    MODEL.axis,
    "the element size",
    dict(zip(SIZES, (lambda size: size, lambda count: 1.0 / count), strict=True)),
    lambda runs: (
        "The elements of the 3-D model shrink about the contact, and the time step with them; "
        "beyond they keep their largest size. Models of the beam do not know the element size, and "
        "agree."
    ),
    Growth(
        "in the contact of a solid, plastic strain gathers at the edge of the dent: its peak grows "
        "as the elements shrink",
        lambda runs: runs["beam_model"] == SOLID,
    ),
)
"""The size of the solid elements about the contact."""


def reasons(file: StudyFile) -> Reasons:
    """Check that the runs have one element size, and what else the 3-D model requires."""
    model, sizes = f"beam_model: {MODEL.name}", size_keys(file, MODEL)
    if not sizes:
        times = "runs with 1 mm take seconds, those with 0.5 mm a minute"
        yield f"discretisation.{SIZES[0]}", f"is required for {model} ({times})"
    for key in sizes[1:]:
        yield key, f"has no effect beside {sizes[0]}: take one of them out"
    if file.discretisation[1] is not None:
        yield "discretisation.auto", f"is not possible with {model}: state the discretisation"
    if file.store.profiles:
        yield "store.profiles", f"must be false with {model}, which has no profiles"
    for entry in outputs.RESPONSES:
        if entry.beam_models_only and entry.name in file.responses:
            yield "responses", f"{entry.name} is not available with {model}: leave it out"
