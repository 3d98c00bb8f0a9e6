"""The elastic Timoshenko beam under Hertz contact: histories against its modal series."""

from __future__ import annotations

from dataclasses import replace

from impactlab.model.impact import Impact
from impactlab.model.paper import paper_impact
from impactlab.verification.cases import aluminium_impact, elastic
from impactlab.verification.finding import Finding
from impactlab.verification.series import Case, compare, panels
from impactlab.verification.solutions import hertz, modal, timoshenko_modal
from impactlab.verification.solutions.modal import ModalSolution
from impactlab.verification.solutions.timoshenko_1913 import timoshenko_impact

TITLE = "Elastic Timoshenko beam: modal series"
SOURCE = (
    "Timoshenko, Phil. Mag. 43 (1922) 125; both spectra of each mode, series in "
    "impactlab.verification.solutions.timoshenko_modal"
)


def _sheared(impact: Impact) -> Impact:
    return replace(elastic(impact), beam_model="timoshenko")


def _stubby() -> Impact:
    """The paper's sphere on a fourth of its span: shear is 6 % of the static deflection."""
    impact = paper_impact()
    return replace(impact, beam=replace(impact.beam, span=0.25 * impact.beam.span))


CASES = {
    "the paper's beam": Case(_sheared(paper_impact()), (0.1, 0.99, 5.0), 0.4e-3),
    "Timoshenko's example": Case(_sheared(timoshenko_impact()), (0.01, 1.0, 5.0), 0.3e-3),
    "a beam of aluminium": Case(_sheared(aluminium_impact()), (0.05, 0.3), 0.4e-3),
    "a stubby beam": Case(_sheared(_stubby()), (0.1, 1.0, 5.0), 1.5e-3),
}


def solve(impact: Impact, duration: float) -> ModalSolution:
    """The series with a step half as large as its default: stubby beams converge fast."""
    modulus, radius = hertz.effective_modulus(impact), hertz.effective_radius(impact)
    args = (impact.sphere.total_mass, impact.velocity, modulus, radius)
    step = hertz.contact_duration(*args) / 2000.0
    return timoshenko_modal.solve(impact, duration, step=step)


def check() -> Finding:
    """Histories at 201 nodes, at 801 nodes, and the order in which their errors fall."""
    case, velocity = CASES["the paper's beam"], 0.99
    impact = replace(case.impact, velocity=velocity)
    title = f"the paper's beam with shear and rotary inertia, {velocity:g} m/s"
    bare = {"modal series without shear": modal.solve(impact, case.duration)}
    return Finding(compare(CASES, solve), panels(title, impact, case.duration, solve, bare))
