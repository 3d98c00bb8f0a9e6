"""Flow laws from outside: fibres follow them, studies name them, and what cannot be is refused."""

import pickle
import warnings
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import impactlab as il
from impactlab.copies import plain
from impactlab.model import flow_law
from impactlab.model.case_table import case_table
from impactlab.report.cautions import notes
from impactlab.solve import fibre_section
from impactlab.solver import FLOW_LAWS, FLOW_LAWS_OUTSIDE, flow_stress, section
from impactlab.solver.strain_rate import RateLaw
from impactlab.study.solvers import kernels

D, Q, H = 40.0, 5.0, 2e9
STEEL = il.paper_impact().beam.material
E, S_Y = STEEL.youngs_modulus, STEEL.yield_stress


def cowper_symonds(p, rate, E, S_y):
    return (S_y + H * p) * (1.0 + (rate / D) ** (1.0 / Q))


def voce(p, rate, E, S_y):
    return S_y * (2.0 - np.exp(-p / 0.01))


def johnson_cook(p, rate, E, S_y):
    return (S_y + 300e6 * p**0.3) * (1.0 + 0.02 * np.log(max(rate, 1.0)))


LAWS = {"cowper_symonds": cowper_symonds, "voce": voce, "johnson_cook": johnson_cook}


@pytest.fixture(autouse=True)
def _session():
    """Forget the laws of each test."""
    yield
    for name in [name for name in flow_law.FLOW_LAW_NAMES if name not in FLOW_LAWS]:
        del flow_law._NAMED[name]
    FLOW_LAWS_OUTSIDE.clear()


def own(name="voce", flow_stress=None, **stated):
    return il.FlowLaw(name=name, flow_stress=flow_stress or LAWS[name], **stated)


def of_metal(velocity=15.0, contact="hertz", **metal):
    impact = il.paper_impact(velocity, contact)
    return replace(impact, beam=replace(impact.beam, material=replace(STEEL, **metal)))


@pytest.fixture(scope="module", params=LAWS)
def fibre(request):
    """Return a law and the function that takes the place of section.flow_at_rate, in Python."""
    function = LAWS[request.param]
    links = flow_stress.substitutes(own(request.param))
    names = section.flow_at_rate, section.elastic_range
    return function, *(plain(links[name]) for name in names)


@pytest.mark.parametrize("dt", [1e-8, 1e-3])
@pytest.mark.parametrize("excess", [1e-9, 1e-4, 0.3, 5.0])
def test_a_fibre_flows_to_the_root(fibre, excess, dt):
    """Against a bracketing solver; kinematic hardening moves the trial stress."""
    function, flow, _ = fibre
    p, H_k = 0.004, 1e9
    trial = -function(p, 0.0, E, S_Y) * (1.0 + excess)
    strain, peeq, _ = flow(section.Moduli(E, S_Y, 0.0, H_k), RateLaw(1.0), trial, 0.0, 0.1, p, dt)

    def missing(slip):
        return -trial - (E + H_k) * slip - function(p + slip, slip / dt, E, S_Y)

    slip = brentq(missing, 0.0, -trial / (E + H_k), xtol=1e-300, rtol=1e-14)
    assert peeq - p == pytest.approx(slip, rel=1e-7)
    assert strain - 0.1 == pytest.approx(-slip, rel=1e-7)


def test_a_slow_fibre_follows_the_curve_and_dissipates_its_area(fibre):
    function, flow, elastic_range = fibre
    moduli, forever = section.Moduli(E, S_Y, 0.0, 0.0), 1e50
    plastic, peeq, work, stress = 0.0, 0.0, 0.0, 0.0
    for strain in np.linspace(0.0, 0.02, 1001)[1:]:
        trial, growth = E * (strain - plastic), E * 2e-5
        plastic, peeq, lost = flow(moduli, RateLaw(1.0), trial, growth, plastic, peeq, forever)
        work, stress = work + lost, E * (strain - plastic)
    expected = brentq(lambda p: E * (0.02 - p) - function(p, 0.0, E, S_Y), 0.0, 0.02)
    assert peeq == pytest.approx(expected, rel=1e-6)
    assert stress == pytest.approx(function(peeq, 0.0, E, S_Y), rel=1e-6)
    area, _ = quad(function, 0.0, peeq, args=(0.0, E, S_Y))
    assert work + S_Y * peeq == pytest.approx(area, rel=2e-4)
    low, high = elastic_range(plastic, peeq, E, S_Y, 0.0, 0.0)
    assert high - low == pytest.approx(2.0 * function(peeq, 0.0, E, S_Y) / E)


def test_linear_hardening_dissipates_its_area_in_one_step():
    """From zero stress beyond the yield stress, where the trapezoidal rule is exact."""
    flow = plain(flow_stress.substitutes(own("cowper_symonds"))[section.flow_at_rate])
    trial = 3.0 * S_Y
    moduli = section.Moduli(E, S_Y, 0.0, 0.0)
    _, peeq, work = flow(moduli, RateLaw(1.0), trial, trial, 0.0, 0.0, 1e50)
    area, _ = quad(cowper_symonds, 0.0, peeq, args=(0.0, E, S_Y))
    assert work + S_Y * peeq == pytest.approx(area, rel=1e-9)


@pytest.mark.long
@pytest.mark.parametrize(
    ("model", "scheme"), [("von_karman", "leapfrog"), ("euler_bernoulli", "modal")]
)
def test_an_impact_is_that_of_the_built_in_law(model, scheme):
    """Hertz's contact, whose force does not know the yield stress that depends on the rate."""
    law = il.register(own("cowper_symonds"))
    grid = il.Discretisation(nodes=41, points=9, scheme=scheme)
    built_in = of_metal(isotropic_hardening_modulus=H, rate_coefficient=D, rate_exponent=Q)
    with warnings.catch_warnings(action="ignore", category=il.TooShortWarning):
        runs = [
            il.simulate(replace(impact, beam_model=model), grid, duration="3 ms")
            for impact in (of_metal(flow_law=law), built_in)
        ]
    for name in ("maximum_deflection", "equivalent_plastic_strain", "midspan_deflection"):
        np.testing.assert_allclose(*(run[name].values for run in runs), rtol=1e-8, atol=1e-15)
    assert runs[0].beam_flow_law.attrs["origin"].endswith(law.source_hash)


def test_registration_refuses_what_no_metal_does(capsys):
    def soft(p, rate, E, S_y):
        return S_y * (1.0 - 0.1 * p)

    def low(p, rate, E, S_y):
        return 0.9 * S_y + E * p

    def slowed(p, rate, E, S_y):
        return S_y / (1.0 + 1e-3 * rate)

    def wild(p, rate, E, S_y):
        return S_y + E * np.log(p)

    for function, reason in (
        (soft, "stress falls at p = "),
        (low, r"begins at 0\.9 S_y"),
        (slowed, "falls with the rate at"),
        (wild, "is not finite"),
        (lambda p, rate, E, S_y: "S_y", r"expected one float|cannot compile"),
    ):
        with pytest.raises(ValueError, match=reason):
            il.register(own("mine", function))
    assert "mine" not in flow_law.FLOW_LAW_NAMES


def test_a_metal_has_one_description_of_its_hardening():
    law = own()
    with pytest.raises(ValueError, match="is not registered"):
        replace(STEEL, flow_law=law)
    il.register(law)
    assert pickle.loads(pickle.dumps(law)).source_hash == law.source_hash
    for stated in ("isotropic_hardening_modulus", "rate_coefficient", "rate_sensitivity"):
        with pytest.raises(ValueError, match=f"Material.{stated} = .*must be 0 with a flow_law"):
            replace(STEEL, flow_law="voce", **{stated: 1.0})
    with pytest.raises(ValueError, match="flow_law = 'ludwik': must be one of linear, voce"):
        replace(STEEL, flow_law="ludwik")
    with pytest.raises(ValueError, match=r"strikes = 2.*must be 1 with a flow_law"):
        replace(of_metal(flow_law="voce"), strikes=2)
    with pytest.raises(ValueError, match='must be "linear" of a sphere'):
        il.Sphere(radius=0.02, material=replace(STEEL, flow_law="voce"))


def test_designs_and_reports_name_the_law_and_its_hash():
    law = il.register(own())
    study = il.Study(
        title="Flow laws",
        impact=of_metal(),
        discretisation=il.Discretisation(nodes=21, points=5),
        duration="1 ms",
        responses=["peak_force"],
        sampling=il.Grid(parameters={"beam_flow_law": ["linear", "voce"]}),
    )
    design = study.design()
    assert design.beam_flow_law.attrs["origin"].endswith(law.source_hash)
    cases = kernels.cases(design, np.arange(2))
    assert cases["beam_flow_law"].tolist() == [0, law.number]
    (note,) = [text for text in notes(design) if "“voce”" in text]
    assert f"source hash {law.source_hash}" in note
    assert "contact knows the yield stress alone" in note
    del flow_law._NAMED["voce"]
    with pytest.raises(ValueError, match=r"flow law 'voce' of this design is .*does not know it"):
        kernels.cases(design, np.arange(2))


def test_fibres_have_the_yield_stress_of_the_metal():
    il.register(own())
    (case,) = case_table(of_metal(flow_law="voce"), il.Discretisation(nodes=21), duration=1e-3)
    z = fibre_section(case).z
    assert fibre_section(case).yield_curvature == S_Y / (E * z[0])
