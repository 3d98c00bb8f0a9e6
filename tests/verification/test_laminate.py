"""Laminates: closed forms, plain rectangles as their limit, frequencies, collapse, energy."""

from dataclasses import replace

import numpy as np
import pytest

import impactlab as il
from impactlab.model.case_table import case_table
from impactlab.solve import fibre_section
from impactlab.solver.section import bend

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")

CORES = {  # share of half the depth, modulus, yield stress, density, from the axis outwards
    "late": [(0.7, 70e9, 320e6, 2700.0)],  # yields after the outer layer
    "early": [(0.7, 120e9, 60e6, 8900.0)],  # before it, though nearer to the axis
    "graded": [(0.3, 70e9, 200e6, 2700.0), (0.4, 110e9, 90e6, 4500.0)],
}
GRID = il.Discretisation(nodes=81, points=32, scheme="modal")


def laminate(layers, velocity=1.0, **changes):
    impact = il.paper_impact(velocity, "hertz")
    beam = replace(impact.beam, shape="laminate", layers=layers)
    return replace(impact, beam=beam, **changes)


def strips(impact, count=200_000):
    """Return place, width of a fine strip above the axis, and its modulus, strength, density."""
    beam, metal = impact.beam, impact.beam.material
    rows = [[float(value) for value in row.split()] for row in beam.layers.split(",")]
    z = (np.arange(count) + 0.5) * 0.5 * beam.depth / count
    ends = 0.5 * beam.depth * np.cumsum([row[0] for row in rows])
    metals = [row[1:] for row in rows]
    metals.append([metal.youngs_modulus, metal.yield_stress, metal.density])
    values = np.array(metals)[np.searchsorted(ends, z)].T
    return z, beam.width * 0.5 * beam.depth / count, *values


@pytest.mark.parametrize("core", CORES)
def test_stiffness_moment_and_mass_are_sums_over_the_layers(core):
    impact = laminate(CORES[core])
    beam, section = impact.beam, impact.beam.section
    z, area, E, S, rho = strips(impact)
    assert beam.bending_stiffness == pytest.approx(2 * (E * z * z).sum() * area, rel=1e-8)
    M_p = beam.material.yield_stress * section.plastic_modulus
    assert M_p == pytest.approx(2 * (S * z).sum() * area, rel=1e-8)
    assert beam.mass_per_length == pytest.approx(2 * rho.sum() * area, rel=1e-8)
    rotary = section.rotary_inertia(beam.material.density)
    assert rotary == pytest.approx(2 * (rho * z * z).sum() * area, rel=1e-8)
    # shear: tau = V Q/(I b), by energy, shear moduli in the ratio of Young's
    Q = (np.cumsum((E * z)[::-1])[::-1] - 0.5 * E * z) * area / beam.width
    energy = 2 * (Q * Q / E).sum() * area
    k = (beam.bending_stiffness / beam.width) ** 2 / (2 * E.sum() * area * energy) * beam.width**2
    assert section.shear_coefficient(0.3) == pytest.approx(k, rel=1e-5)


@pytest.mark.parametrize("rule", ["lobatto", "legendre", "layers"])
@pytest.mark.parametrize("core", CORES)
def test_the_moment_of_the_kernels_is_that_of_the_layers(core, rule):
    """From elastic to nearly plastic, and back: residual moments, too."""
    impact = laminate(CORES[core])
    grid = il.Discretisation(points=96, rule=rule)
    cut = fibre_section(case_table(impact, grid, duration=1e-3)[0])
    z, area, E, S, _ = strips(impact)
    first = (S / (E * z)).min()
    assert cut.yield_curvature == pytest.approx(first, rel=0.05)  # a fibre lies beside the edge
    plastic, peeq = np.zeros((2, 1, 48))
    strain = np.zeros(z.size)
    for times in (0.9, 1.5, 4.0, 30.0, 25.0, -3.0):
        kappa = times * first
        M_0, _, _ = bend(cut, kappa, plastic, peeq, 0)
        stress = np.clip(E * (z * kappa - strain), -S, S)
        strain = z * kappa - stress / E
        exact = 2 * (stress * z).sum() * area
        M_p = 2 * (S * z).sum() * area
        assert cut.stiffness * kappa - M_0 == pytest.approx(exact, rel=0, abs=3e-3 * M_p)
    real = plastic[0] * cut.strain_ratio
    places = cut.z * cut.strain_ratio
    expected = -np.interp(places, z, strain)
    inside = (
        np.abs(
            places[:, np.newaxis] - np.cumsum([r[0] for r in CORES[core]]) * 0.5 * impact.beam.depth
        ).min(axis=1)
        > 1e-4
    )
    assert real[inside] == pytest.approx(expected[inside], rel=1e-3, abs=1e-6)


@pytest.mark.parametrize(
    ("scheme", "model"),
    [("leapfrog", "euler_bernoulli"), ("modal", "euler_bernoulli"), ("leapfrog", "timoshenko")],
)
def test_layers_of_the_same_metal_are_a_rectangle(scheme, model):
    steel = il.paper_impact().beam.material
    row = steel.youngs_modulus, steel.yield_stress, steel.density
    grid = il.Discretisation(nodes=81, points=64, rule="layers", scheme=scheme)
    impacts = (
        laminate([(0.25, *row), (0.5, *row)], 12.0, beam_model=model),
        replace(il.paper_impact(12.0, "hertz"), beam_model=model),
    )
    ours, plain = (il.simulate(impact, grid, duration=2e-3) for impact in impacts)
    for name in ("peak_force", "plastic_dissipation", "peak_plastic_strain", "impulse"):
        assert ours[name].item() == pytest.approx(plain[name].item(), rel=1e-6, nan_ok=True)
    strains = ours.equivalent_plastic_strain.values, plain.equivalent_plastic_strain.values
    np.testing.assert_allclose(*strains, rtol=1e-5, atol=1e-7)


@pytest.mark.parametrize("scheme", ["leapfrog", "modal"])
@pytest.mark.parametrize("core", CORES)
def test_a_struck_laminate_keeps_the_balance_of_energy(core, scheme):
    """Its strains are the real ones: their work is what the fibres dissipate."""
    impact = laminate(CORES[core], 12.0)
    grid = replace(GRID, scheme=scheme)
    run = il.simulate(impact, grid, duration=3e-3)
    assert run.energy_error < 1e-3
    assert run.plastic_dissipation > 0.02 * 0.5 * run.sphere_mass * 12.0**2
    z, _, E, S, _ = strips(impact)
    places, fibres = impact.beam.section.cut("lobatto", 32)
    ratio = np.interp(abs(places), z, E) / impact.beam.material.youngs_modulus
    real = fibres / ratio  # their areas, of their own metal
    strength = S[np.searchsorted(z, abs(places) - 1e-9).clip(0, z.size - 1)]
    peeq = run.equivalent_plastic_strain
    weights = np.full(81, impact.beam.span / 80)
    work = (peeq.transpose("x", "z").values * (real * strength)).sum(axis=1) @ weights
    assert run.plastic_dissipation.item() == pytest.approx(work, rel=2e-3)
    assert run.peak_plastic_strain.item() == pytest.approx(peeq.max().item(), rel=1e-12)


@pytest.mark.parametrize("core", CORES)
def test_a_laminate_vibrates_as_its_layers_have_it(core):
    """omega = pi^2 sqrt(EI/(rho A L^4)); it collapses under 4 M_p/L as every shape does."""
    impact = laminate(CORES[core], 0.3, gravity=0.0)
    z, _, E, _, rho = strips(impact)
    light = replace(impact, sphere=replace(impact.sphere, radius=0.004), beam_model="elastic")
    run = il.simulate(light, GRID, duration=0.06, samples=6001)
    assert run.number_of_contacts == 1
    w, t = run.midspan_deflection.values[200:], run.time.values[200:]
    omega = np.pi**2 * np.sqrt((E * z * z).sum() / rho.sum()) / impact.beam.span**2
    waves = [f(n * n * omega * t) for n in (1, 3, 5, 7, 9, 11, 13) for f in (np.cos, np.sin)]
    fit = np.stack(waves, axis=1)
    rest = w - fit @ np.linalg.lstsq(fit, w, rcond=None)[0]
    assert np.abs(rest).max() < 2e-2 * np.abs(w).max()


@pytest.mark.parametrize(
    ("layers", "message"),
    [
        (None, "None: must be stated with shape: laminate"),
        ("0.5 70e9 3e8", "must be rows of share"),
        ("0.5 70e9 3e8 2700, 0.5 70e9 3e8 2700", "must leave a share to the outer layer"),
        ("0.5 70e9 -3e8 2700", "must have numbers above zero"),
        ([(0.05, 70e9, 3e8, 2700.0)] * 9, "1 to 8"),
    ],
)
def test_layers_that_make_no_laminate_are_refused(layers, message):
    with pytest.raises(ValueError, match=rf"^Beam\.layers = .*{message}"):
        laminate(layers)


def test_what_a_laminate_lacks_is_refused():
    few = il.Discretisation(points=7)
    with pytest.raises(ValueError, match=r"points = 7: must be at least 8 with so many layers"):
        case_table(laminate(CORES["late"]), few, duration=1e-3)
    impact = laminate(CORES["late"])
    for field, value in {"isotropic_hardening_modulus": 1e9, "rate_coefficient": 40.0}.items():
        metal = replace(impact.beam.material, **{field: value})
        with pytest.raises(ValueError, match=rf"^Material\.{field} = .* must be 0 with shape: lam"):
            replace(impact.beam, material=metal)


def test_sizes_and_the_outer_metal_of_a_laminate_are_factors():
    base = laminate(CORES["graded"]), il.Discretisation(nodes=5, points=16)
    varied = {"beam_depth": [0.02, 0.03], "beam_youngs_modulus": [1e11, 2e11]}
    cases = case_table(*base, duration=1e-3, varied=varied)
    for case, depth, modulus in zip(cases, *varied.values(), strict=True):
        beam = base[0].beam
        beam = replace(beam, depth=depth, material=replace(beam.material, youngs_modulus=modulus))
        single = case_table(replace(base[0], beam=beam), base[1], duration=1e-3)
        assert case.tobytes() == single[0].tobytes()
