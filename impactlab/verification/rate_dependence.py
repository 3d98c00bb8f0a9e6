"""Yielding at a strain rate: closed forms of section and contact, and both schemes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import xarray as xr

from impactlab.model.case_table import case_table
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, paper_impact
from impactlab.simulate import fibre_section, run_dataset
from impactlab.solver.section import bend_at_rate
from impactlab.solver.strain_rate import CowperSymonds
from impactlab.types import Floats
from impactlab.verification.cases import with_beam_material
from impactlab.verification.finding import Comparisons, Curve, CurvePanel, Finding, check
from impactlab.verification.solutions import hertz

D, Q = 40.4, 5.0
_RATES = np.array([0.1, 10.0, 1000.0])  # strain rates of the outermost fibre, 1/s


@check(
    "Strain rate",
    "closed form of the moment at a constant curvature rate; yield stress under the contact from "
    "Hertz's impact; both schemes",
)
def strain_rate() -> Finding:
    """Compare moments, contacts and impacts after Cowper and Symonds.

    Moments: the paper's section at 60 times its yield curvature, where the elastic core holds less
    than 1e-4. Contacts: at a yield stress raised by hand. Impacts: 20 m/s on 201 nodes, 1 ms.
    """
    impact = with_beam_material(paper_impact(20.0), rate_coefficient=D, rate_exponent=Q)
    beam, static = impact.beam, impact.beam.material.yield_stress
    plastic = static * beam.section.plastic_modulus
    closed = plastic * (1.0 + 2.0 * Q / (2.0 * Q + 1.0) * (_RATES / D) ** (1.0 / Q))
    ours = _moments(impact, _RATES)
    comparisons = Comparisons()
    for rate, mine, exact in zip(_RATES, ours, closed, strict=True):
        where = f"{rate:g} 1/s at the surface"
        comparisons.at(where).relative("moment", "N m", mine, exact, 1e-3)
    _compare_contacts(comparisons, impact)
    comparisons.at("20 m/s, contact patch")
    leapfrog, modal = (_run(impact, scheme) for scheme in ("leapfrog", "modal"))
    for name, tolerance in (("peak_plastic_strain", 0.02), ("plastic_dissipation", 0.02)):
        label, units = f"{name.replace('_', ' ')}, leapfrog beside modal", leapfrog[name].units
        values = leapfrog[name].item(), modal[name].item()
        comparisons.relative(label, units, *values, tolerance)
    curves = [Curve("solver", _RATES, ours), Curve("closed form", _RATES, closed, independent=True)]
    axes = ("strain rate at the surface", "s-1"), ("moment", "N m")
    return Finding(comparisons, [CurvePanel("bent at a constant rate", *axes, curves, log=True)])


def _moments(impact: Impact, rates: Floats) -> Floats:
    """Return the moments (N m) of the solver's section, bent at these rates of the surface."""
    grid = Discretisation(rule="layers", points=64)
    cut, law = fibre_section(case_table(impact, grid, duration=1.0)[0]), CowperSymonds(D, Q)
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


def _compare_contacts(comparisons: Comparisons, impact: Impact) -> None:
    """Compare contacts of the rate with those of the yield stress at the rate that Hertz gives."""
    for velocity in (0.99, 10.0):
        dynamic = replace(impact, velocity=velocity, beam_model="elastic")
        mass, radius = dynamic.sphere.total_mass, dynamic.sphere.radius
        bodies = (mass, velocity, hertz.effective_modulus(dynamic), radius)
        circle = np.sqrt(hertz.maximum_indentation(*bodies) / radius)
        rate = 0.2 * circle / (0.5 * hertz.contact_duration(*bodies))
        raised = 345e6 * (1.0 + float(rate / D) ** (1.0 / Q))
        still = with_beam_material(dynamic, rate_coefficient=0.0, yield_stress=raised)
        run, reference = (_run(case, "modal") for case in (dynamic, still))
        expected = {name: reference[name].item() for name in ("peak_force", "maximum_indentation")}
        where = f"{velocity:g} m/s, {rate:.0f} 1/s under the contact"
        comparisons.at(where).responses(run, expected, 1e-5)


def _run(impact: Impact, scheme: str) -> xr.Dataset:
    grid = Discretisation(nodes=201, points=9, scheme=scheme)
    return run_dataset(replace(impact, load="contact_patch"), grid, duration=1e-3, samples=2)
