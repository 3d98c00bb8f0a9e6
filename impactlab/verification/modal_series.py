"""The elastic beam under Hertz contact: histories against the modal series."""

from __future__ import annotations

from dataclasses import replace

from impactlab.model.paper import paper_impact
from impactlab.verification.cases import aluminium_impact, elastic
from impactlab.verification.finding import Finding
from impactlab.verification.series import Case, compare, panels
from impactlab.verification.solutions.modal import solve
from impactlab.verification.solutions.timoshenko_1913 import timoshenko_impact

TITLE = "Elastic beam: modal series"
SOURCE = (
    "Timoshenko, Z. Math. Phys. 62 (1913) 198; Goldsmith, Impact (1960); series in "
    "impactlab.verification.solutions.modal"
)

CASES = {
    "the paper's beam": Case(elastic(paper_impact()), (0.1, 0.99, 2.0, 5.0), 0.4e-3),
    "Timoshenko's beam": Case(elastic(timoshenko_impact()), (0.01, 0.1, 1.0, 5.0), 0.3e-3),
    "a beam of aluminium": Case(elastic(aluminium_impact()), (0.05, 0.1, 0.3, 0.8), 0.4e-3),
}


def check() -> Finding:
    """Histories at 201 nodes, at 801 nodes, and the order in which their errors fall."""
    case, velocity = CASES["the paper's beam"], 0.99
    impact = replace(case.impact, velocity=velocity)
    title = f"the paper's beam, {velocity:g} m/s"
    return Finding(compare(CASES, solve), panels(title, impact, case.duration, solve))
