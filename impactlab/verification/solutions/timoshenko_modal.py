"""Elastic Timoshenko beam struck at mid-span under Hertz contact: the modal series.

The series of reference.modal with the modes of Timoshenko's theory, of both spectra.
Source: as reference.modal, for the contact; S. Timoshenko, Phil. Mag. 43 (1922) 125, for the beam.
Modes in timoshenko_modes, march in time in modal_march.
"""

from __future__ import annotations

from impactlab.model.impact import Impact
from impactlab.verification.solutions.modal import ModalSolution, solve_with
from impactlab.verification.solutions.timoshenko_modes import odd_modes


def solve(
    impact: Impact,
    duration: float,
    *,
    modes: int = 100,
    step: float | None = None,
    compliance: float = 0.0,
) -> ModalSolution:
    """The impact on an elastic Timoshenko beam over `duration` (s), with that many odd n.

    step as in modal.solve, compliance as in modal.solve_with. Errors fall with modes^-3; in the
    paper's case 100 leave below 1e-7 of peak force and contact duration, and 1e-5 of the largest
    curvature. amplitudes and rates of the solution have the shape (time, 2 modes): the lower
    spectrum, then the higher one.

    Raises ValueError as modal.solve does.
    """
    return solve_with(odd_modes(impact.beam, modes), impact, duration, step, compliance)
