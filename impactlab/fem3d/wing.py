"""Additions of this wing to the core: a command, and the model `solid` beside the beam models."""

from impactlab.wings import FurtherModel, Size, Wing

SOLID = "solid"
"""The word for this model."""
_ALONE = "of the 3-D model alone: NaN for models of the beam"

MODEL = FurtherModel(
    name=SOLID,
    label="3-D FE model",
    solver="witness",
    trait="fem3d",
    advice="use `impactlab witness`, impactlab.fem3d.solver.solve, or a study",
    sizes=(
        Size(
            name="element_size",
            units="m",
            long_name="size of the solid elements about the contact",
            cost_power=-4,
        ),
        Size(
            name="elements_per_radius",
            units="1",
            long_name="solid elements over the expected contact radius",
            cost_power=4,
        ),
    ),
    axis="element_size",
    axis_title="Convergence in the size of the solid elements",
    variables=(
        (
            "plastic_zone_radius",
            "m",
            "distance from the centre of the impact to which the struck surface has a PEEQ above "
            "0.2 %",
            _ALONE,
        ),
        (
            "plastic_zone_depth",
            "m",
            "depth below the centre of the impact to which the beam has a PEEQ above 0.2 %",
            _ALONE,
        ),
        (
            "processor_time",
            "s",
            "processor time of the run, meshing included",
            f"{_ALONE}; differs from run to run",
        ),
    ),
    references={
        "solver": "impactlab.fem3d.study_solver:SOLVER",
        "axis": "impactlab.fem3d.study_rules:ELEMENT_SIZE",
        "checks": "impactlab.fem3d.study_rules:reasons",
        "costs": "impactlab.fem3d.study_solver",
        "figures": "impactlab.fem3d.figures.witness:FIGURES",
        "sections": "impactlab.fem3d.report:sections",
        "compile": "impactlab.fem3d.solver.dataset:compile_all",
    },
)
SIZES = tuple(size.name for size in MODEL.sizes)
"""Names of the sizes of its elements, of which a run needs one."""
VARIABLES = tuple(name for name, *_ in MODEL.variables)
"""Names of its answers beside those of the beam models."""
UNLIKE: dict[str, str] = dict.fromkeys(
    ("peak_plastic_strain", "plastic_zone_length", "plastic_dissipation"),
    "with the contact in 3-D, of bending alone in the beam models",
) | {"energy_error": "of each model's own balance"}
"""Responses that are not the same quantity in the 3-D model and in those of the beam, and why."""
WING = Wing(
    commands={"witness": "impactlab.fem3d.command:witness"},
    contents={"witness": "impactlab witness", "beams": "impactlab witness"},
    models=(MODEL,),
)
