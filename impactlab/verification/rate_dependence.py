"""Yielding at a strain rate: closed forms of section and contact, and both schemes."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import xarray as xr

from impactlab.model.case_table import case_table
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, paper_impact
from impactlab.simulate import run_dataset
from impactlab.solve import fibre_section
from impactlab.solver.contact.history import CONTACT, load, make_pair
from impactlab.solver.contact.rate import strain
from impactlab.solver.section import bend_at_rate
from impactlab.solver.strain_rate import rate_law
from impactlab.types import Floats
from impactlab.verification.cases import with_beam_material
from impactlab.verification.finding import (
    ROUNDING,
    Comparisons,
    Curve,
    CurvePanel,
    Finding,
    Reference,
    check,
)

D, Q, C = 40.4, 5.0, 0.03
_LAWS: Mapping[str, dict[str, float]] = {
    "Cowper-Symonds": {"rate_coefficient": D, "rate_exponent": Q},
    "Johnson-Cook": {"rate_sensitivity": C, "reference_rate": 0.001},
}
_RATES = np.array([0.1, 10.0, 1000.0])  # strain rates of the outermost fibre or the contact, 1/s


@check(
    "Strain rate",
    "closed forms of the moment at a constant curvature rate, and of the yield stress of a contact "
    "at a constant strain rate; both schemes",
    Reference(
        "closed form",
        1e-4,
        "of moments, the elastic core; of contacts, rounding; of the modal scheme beside leapfrog, "
        "what twice the nodes change",
        {"yield stress": ROUNDING, "peak plastic strain": 1.5e-3, "plastic dissipation": 1.2e-3},
    ),
)
def strain_rate() -> Finding:
    """Compare moments and contacts after both laws, and impacts after Cowper and Symonds.

    Moments: the paper's section at 60 times its yield curvature, where the elastic core holds less
    than 1e-4. Contacts: to a representative strain of 0.1. Impacts: 20 m/s on 201 nodes, 1 ms.
    """
    laws = {name: with_beam_material(paper_impact(20.0), **law) for name, law in _LAWS.items()}
    impact = laws["Cowper-Symonds"]
    beam, static = impact.beam, impact.beam.material.yield_stress
    closed = {
        "Cowper-Symonds": 1.0 + 2.0 * Q / (2.0 * Q + 1.0) * (_RATES / D) ** (1.0 / Q),
        "Johnson-Cook": 1.0 + C * (np.log(_RATES / 0.001) - 0.5),
    }
    factors = {"Cowper-Symonds": 1.0 + (_RATES / D) ** (1.0 / Q)}
    factors["Johnson-Cook"] = 1.0 + C * np.log(_RATES / 0.001)
    comparisons, curves = Comparisons(), []
    for name, dynamic in laws.items():
        moments = _moments(dynamic, _RATES)
        exact = static * beam.section.plastic_modulus * closed[name]
        stresses = _contact_stresses(dynamic, _RATES)
        for i, rate in enumerate(_RATES):
            comparisons.at(f"{name}, {rate:g} 1/s")
            comparisons.relative("moment", "N m", moments[i], exact[i], 1e-3)
            yields = static * float(factors[name][i])
            comparisons.relative("yield stress of the contact", "Pa", stresses[i], yields, 1e-3)
        curves += [
            Curve(f"solver, {name}", _RATES, moments),
            Curve(f"closed form, {name}", _RATES, exact, independent=True),
        ]
    comparisons.at("20 m/s, contact patch")
    leapfrog, modal = (_run(impact, scheme) for scheme in ("leapfrog", "modal"))
    for name, tolerance in (("peak_plastic_strain", 0.02), ("plastic_dissipation", 0.02)):
        label, units = f"{name.replace('_', ' ')}, leapfrog beside modal", leapfrog[name].units
        values = leapfrog[name].item(), modal[name].item()
        comparisons.relative(label, units, *values, tolerance)
    axes = ("strain rate at the surface", "s-1"), ("moment", "N m")
    return Finding(comparisons, [CurvePanel("bent at a constant rate", *axes, curves, log=True)])


def _moments(impact: Impact, rates: Floats) -> Floats:
    """Return the moments (N m) of the solver's section, bent at these rates of the surface."""
    case = case_table(impact, Discretisation(rule="layers", points=64), duration=1.0)[0]
    cut, law = fibre_section(case), rate_law(case)
    moments, steps, last = [], 200, 60.0 * cut.yield_curvature
    for rate in rates:
        dt = 0.5 * impact.beam.depth * last / steps / rate
        strain, peeq, before = np.zeros((1, 32)), np.zeros((1, 32)), 0.0
        moment = np.nan
        for kappa in np.linspace(0.0, last, steps + 1)[1:]:
            plastic, _, _, _ = bend_at_rate(cut, law, float(kappa), before, dt, strain, peeq, 0)
            moment, before = cut.stiffness * kappa - plastic, float(kappa)
        moments.append(moment)
    return np.array(moments)


def _contact_stresses(impact: Impact, rates: Floats) -> Floats:
    """Return the yield stress (Pa) of a contact at these representative strain rates.

    Of a law whose contact radius is that of Hertz, sqrt(R delta), indented by R (5 t rate)^2.
    """
    case = case_table(replace(impact, contact="thornton"), Discretisation(), duration=1.0)[0]
    pair, stresses, steps = make_pair(case), [], 4000
    for rate in rates:
        contact, dt = np.zeros(1, CONTACT)[0], 0.1 / steps / rate
        for step in range(1, steps + 1):
            delta = pair.R * (5.0 * step * dt * float(rate)) ** 2
            strain(contact, pair, delta, dt)
            load(contact, pair, delta)
        stresses.append(contact.stress)
    return np.array(stresses)


def _run(impact: Impact, scheme: str) -> xr.Dataset:
    grid = Discretisation(nodes=201, points=9, scheme=scheme)
    return run_dataset(replace(impact, load="contact_patch"), grid, duration=1e-3, samples=2)
