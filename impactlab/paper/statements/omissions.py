"""Statements on what the paper's model leaves out: shear, strain rate, and the cost of a solid."""

import time
from collections.abc import Sequence

import numpy as np

from impactlab.fem3d.wing import SOLID
from impactlab.figures import labels
from impactlab.model.case_table import case_table
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import paper_impact
from impactlab.paper.statements.statement import (
    BEAM,
    PRINTED_DIFFERENCE,
    VELOCITY,
    Assessment,
    Data,
    Number,
    UnknownError,
    finest_grid,
    judged,
    runs_of,
    statement,
)
from impactlab.solve import solve

EFFECTS_STUDY, MESHES_STUDY = "fig05_effects", "witness_mesh"
"""Studies: with and without shear; the 3-D model on finer meshes."""
RATES = {
    "first yield": {"fig05_rate": "beam_rate_coefficient"},
    "flow": {"fig05_flow": "beam_rate_coefficient", "fig05_johnson_cook": "beam_rate_sensitivity"},
}
"""Studies over the strain rate, by the kind of their constants, and what each varies."""
RESPONSES = {"peak_force": "peak force", "contact_duration": "contact duration"}
SMALL = {
    "negligible: no more than the numerical uncertainty": 0.0,
    f"small: no more than the paper's own {100 * PRINTED_DIFFERENCE:g} %": PRINTED_DIFFERENCE,
}
"""Readings of what may be ignored, and the largest change under each."""
_CASES = tuple(
    (f"{velocity:g} m/s, {label}", velocity, limit)
    for velocity in (VELOCITY, 5.0, 10.0)
    for label, limit in SMALL.items()
)
_LIMITS = (
    "The paper gives no number; two readings: 0, and the 2.4 % that it states for its force "
    "against finite elements."
)


@statement(
    text="Shear deformation may be ignored.",
    test=(
        "|f(Timoshenko)/f(Euler-Bernoulli) − 1| − U ≤ limit for the peak force and the duration of "
        f"the first contact. {_LIMITS}"
    ),
    cases=_CASES,
    studies=(EFFECTS_STUDY,),
)
def shear(data: Data, velocity: float, limit: float) -> Assessment:
    """Judge what shear and rotary inertia change."""
    runs = runs_of(data, EFFECTS_STUDY)
    gaps = []
    for name, label in RESPONSES.items():
        with_shear, without = (
            finest_grid(runs, name, velocity=velocity, beam_model=model)
            for model in ("timoshenko", BEAM)
        )
        gaps.append(with_shear.relative_to(without, f"change of the {label}"))
    return _judge_changes(gaps, limit)


def _judge_changes(gaps: Sequence[Number], limit: float) -> Assessment:
    """Judge changes of responses against the limit of a reading."""
    small = all(gap.within(limit) for gap in gaps)
    worst = max(gaps, key=lambda gap: abs(gap.value))
    why = f"The largest is the {worst.name}, {labels.number(100 * worst.value, 2)} %."
    return judged(tuple(gaps), small, why, literal=not limit)


@statement(
    text="Strain-rate effects are negligible.",
    test=(
        "|f(rate)/f(static) − 1| − U ≤ limit for the peak force and the duration of the first "
        "contact of the corrected beam model, which is within 2 % of 3-D in what the rate changes; "
        "f(rate): with the yield stress by the strain rate in fibres and contact. Constants of "
        "first yield: Cowper and Symonds' q = 5, D from 40.4/s (mild steel) to 3200/s "
        "(high-tensile steel). Constants of flow, which the strains under the contact ask for: "
        "their D = 6844/s, q = 3.91 (mild steel, after Abramowicz and Jones), and Johnson and "
        "Cook's C = 0.014 (4340 steel) and 0.022 (1006 steel) with a reference rate of 1/s; all "
        "as remembered, none of the paper's Q345. "
        "The value is the middle between the smallest and the largest change over the constants, U "
        f"half of their distance with the numerical uncertainty. {_LIMITS}"
    ),
    cases=tuple(
        (f"{case}, constants of {kind}", velocity, limit, kind)
        for kind in RATES
        for case, velocity, limit in _CASES
    ),
    studies=tuple(study for studies in RATES.values() for study in studies),
)
def strain_rate(data: Data, velocity: float, limit: float, kind: str) -> Assessment:
    """Judge what a yield stress that depends on the strain rate changes."""
    gaps = []
    for name, label in RESPONSES.items():
        changes = [
            change
            for study, varied in RATES[kind].items()
            for change in _rate_changes(data, study, varied, velocity, name)
        ]
        low, high = min(gap.low for gap in changes), max(gap.high for gap in changes)
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        gaps.append(Number(f"change of the {label}", middle, "1", half, percent=True))
    return _judge_changes(gaps, limit)


def _rate_changes(
    data: Data, study: str, varied: str, velocity: float, response: str
) -> list[Number]:
    """Return what each value of the varied constant changes in a response."""
    runs = runs_of(data, study)
    if varied not in runs.dims:
        raise UnknownError(f"the study {study} does not vary {varied}")
    static = finest_grid(runs, response, velocity=velocity, **{varied: 0.0})
    constants = runs[varied].values.astype(float)
    return [
        finest_grid(runs, response, velocity=velocity, **{varied: constant}).relative_to(
            static, RESPONSES[response]
        )
        for constant in constants[constants > 0.0]
    ]


@statement(
    text="The semi-analytical run takes marginal time beside finite elements: it is very fast.",
    test=(
        "T(beam) < T(3-D) on every mesh; T: processor time on one core of 0.45 ms at 0.99 m/s, the "
        "beam with 601 nodes, measured when this page is made (least of five), the 3-D model's as "
        "stored with its runs. The paper gives no times; the program of the solid plays a part."
    ),
    cases=(("this project's two models",),),
    studies=(MESHES_STUDY,),
)
def run_time(data: Data) -> Assessment:
    """Judge the processor times of the beam and of the 3-D model."""
    runs = runs_of(data, MESHES_STUDY)
    if "processor_time" not in runs or "element_size" not in runs.dims:
        raise UnknownError(f"the study {MESHES_STUDY} holds no processor times: solve it again")
    times = runs["processor_time"].sel(beam_model=SOLID).sortby("element_size")
    if not np.isfinite(times).all():
        raise UnknownError(f"a run of the study {MESHES_STUDY} has no processor time")
    beam = _beam_time(float(runs["duration"]))
    numbers = [Number("beam", beam, "s")]
    for mesh in (0, -1):
        size = f"{1e3 * float(times['element_size'][mesh]):g} mm"
        solid = float(times[mesh])
        numbers.append(Number(f"3-D, elements of {size}", solid / 60.0, "min"))
        numbers.append(Number(f"times the beam's ({size})", solid / beam, "1"))
    why = "Finite elements take many times as long, on every mesh."
    return judged(tuple(numbers), beam < float(times.min()), why, "The beam takes longer.")


def _beam_time(duration: float) -> float:
    """Return the processor time in s of the paper's case, the least of five runs of the kernel."""
    grid = Discretisation(nodes=601, points=9)
    cases = case_table(paper_impact(), grid, duration=duration, varied={"velocity": [VELOCITY]})
    times = []
    for _ in range(6):  # the first may compile
        begun = time.process_time()
        solve(cases)
        times.append(time.process_time() - begun)
    return min(times[1:])
