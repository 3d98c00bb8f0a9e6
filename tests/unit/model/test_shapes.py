"""Shapes of the section against adaptive quadrature of their width, and closed forms of shear."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad
from shapes import BREAKS, SIZES, WIDTHS, beam_of, parameters_of

import impactlab as il
from impactlab.model.case_table import case_table
from impactlab.model.parameters import with_values
from impactlab.model.section import fibre_table
from impactlab.model.shapes import Box, Circle, ISection, Tube
from impactlab.solve import fibre_section
from impactlab.solver import RULES
from impactlab.solver.section import bend

FURTHER = [shape for shape in SIZES if shape != "rectangle"]
RHO, E = 7800.0, 2.1e11


def integral(shape, function):
    """Twice the integral of the width times a function of z over the upper half."""
    width, ends = WIDTHS[shape], [0.0, *BREAKS.get(shape, []), 0.015]
    return 2 * sum(
        # with z = high - (high - low) s^2, no vertical tangent
        quad(
            lambda s, low=low, high=high: (
                width(z := high - (high - low) * s**2) * function(z) * 2 * (high - low) * s
            ),
            *(0.0, 1.0),
            epsabs=0.0,
            epsrel=1e-12,
            limit=200,
        )[0]
        for low, high in itertools.pairwise(ends)
    )


@pytest.mark.parametrize("shape", SIZES)
def test_properties_are_integrals_of_the_width(shape):
    section = beam_of(shape).section
    area, first, second = (integral(shape, lambda z, k=k: z**k) for k in range(3))
    assert section.area == pytest.approx(area, rel=1e-10)
    assert section.plastic_modulus == pytest.approx(first, rel=1e-10)
    assert section.second_moment == pytest.approx(second, rel=1e-10)
    assert section.stress_per_moment == pytest.approx(0.015 / second, rel=1e-10)
    assert section.mass_per_length(RHO) == pytest.approx(RHO * area, rel=1e-10)
    assert section.rotary_inertia(RHO) == pytest.approx(RHO * second, rel=1e-10)
    assert section.bending_stiffness(E) == pytest.approx(E * second, rel=1e-10)
    z, fibre = section.fibres((np.arange(40) + 0.5) / 20 - 1, np.full(40, 0.05))
    if shape != "rectangle":
        assert fibre == pytest.approx(0.03 / 40 * WIDTHS[shape](z), rel=1e-12)


@pytest.mark.parametrize("points", [4, 5, 9, 32, 128])
@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("shape", FURTHER)
def test_fibres_have_area_stiffness_and_plastic_moment_exactly(shape, rule, points):
    """Layers have the stiffness to the second order."""
    section = beam_of(shape).section
    if shape == "laminate" and points < 8:
        pytest.skip("each of two layers needs two fibres above the axis")
    z, area = section.cut(rule, points)
    assert z.shape == area.shape == (points,)
    np.testing.assert_array_equal(z, -z[::-1])
    np.testing.assert_array_equal(area, area[::-1])
    assert np.all(np.diff(z) > 0)
    assert np.all(area[z != 0] > 0)
    assert area[z == 0].sum() == 0
    assert z[-1] == 0.015 if rule == "lobatto" else z[-1] < 0.015
    assert area.sum() == pytest.approx(section.area, rel=1e-13)
    assert area @ abs(z) == pytest.approx(section.plastic_modulus, rel=1e-13)
    error = 1 - area @ z**2 / section.second_moment
    if rule == "layers":
        assert 0 < error * (points // 2) ** 2 < 0.4
    else:
        assert abs(error) < 1e-13
        fibres = 2 if shape == "laminate" else points // 2  # of the layer with the fewest
        highest = 2 * fibres - (1 if rule == "legendre" else 2)
        for power in range(3, min(highest, 9) + 1):
            exact = integral(shape, lambda z, k=power: (z / 0.015) ** k)
            assert area @ abs(z / 0.015) ** power == pytest.approx(exact, rel=1e-11)


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("shape", FURTHER)
def test_moment_of_the_kernels_tends_to_the_integral_of_the_stress(shape, rule):
    """The error is of second order in the points, from yield to eight times its curvature."""
    beam = beam_of(shape)
    E, S_y = beam.material.youngs_modulus, beam.material.yield_stress
    curvatures = np.linspace(1.0, 8.0, 29) * S_y / (E * 0.015)
    exact = np.empty(curvatures.size)
    for k, kappa in enumerate(curvatures):
        edge = S_y / (E * kappa)
        with pytest.MonkeyPatch.context() as patch:
            patch.setitem(BREAKS, shape, sorted({*BREAKS.get(shape, []), min(edge, 0.0149999)}))
            exact[k] = integral(shape, lambda z, c=kappa: z * np.minimum(E * c * z, S_y))
    impact = replace(il.paper_impact(), beam=beam)
    counts, errors = (8, 32, 128), []
    for points in counts:
        grid = il.Discretisation(points=points, rule=rule)
        cut = fibre_section(case_table(impact, grid, duration=1e-3)[0])
        plastic, peeq = np.zeros((2, 1, points // 2))
        moments = [cut.stiffness * c - bend(cut, c, plastic, peeq, 0)[0] for c in curvatures]
        errors.append(np.abs(moments / exact - 1).mean())
    assert errors[0] < 0.012
    assert np.polyfit(np.log(counts), np.log(errors), 1)[0] == pytest.approx(-2.0, abs=0.25)


def of_energy(area, second, flows):
    """Return I^2/(A integral of Q^2/t ds): flows: first moment over s, thickness, length, count."""
    work = sum(n * quad(lambda s, Q=Q: Q(s) ** 2, 0.0, length)[0] / t for Q, t, length, n in flows)
    return second**2 / (area * work)


@pytest.mark.parametrize("ratio", [0.5, 1.0, 3.0])
def test_shear_coefficients_without_lateral_strain_are_those_of_energy(ratio):
    """Thin walls have a shear flow; h: between the middles of the flanges."""
    h, b, t = 2.0, 2.0 * ratio, 1e-5
    area, second = 2 * (b + h) * t, t * b * h**2 / 2 + t * h**3 / 6
    flange = (lambda s: t * h / 2 * s, t, b / 2, 4)
    web = (lambda s: t * b * h / 4 + t / 2 * (h**2 / 4 - s**2), t, h / 2, 4)
    k = Box(b + t, h + t, t).shear_coefficient(0.0)
    assert k == pytest.approx(of_energy(area, second, [flange, web]), rel=1e-4)
    area, second = 2 * b * t + h * t, t * b * h**2 / 2 + t * h**3 / 12
    web = (lambda s: t * b * h / 2 + t / 2 * (h**2 / 4 - s**2), t, h / 2, 2)
    k = ISection(b, h + t, t, t).shear_coefficient(0.0)
    assert k == pytest.approx(of_energy(area, second, [flange, web]), rel=1e-4)


def test_shear_coefficients_of_round_sections():
    """Thin tubes by energy, V sin(phi)/(pi r t): 1/2; the others from Cowper's table for 0.3."""
    tube = Tube(1.0, 1.0, 1e-6)
    assert tube.shear_coefficient(0.0) == pytest.approx(0.5, rel=1e-5)
    assert tube.shear_coefficient(0.3) == pytest.approx(0.531, abs=5e-4)
    assert Circle(1.0, 1.0).shear_coefficient(0.3) == pytest.approx(0.886, abs=5e-4)
    # a tube that is nearly solid
    assert Tube(1.0, 1.0, 0.5 - 1e-6).shear_coefficient(0.2) == pytest.approx(
        Circle(1.0, 1.0).shear_coefficient(0.2), rel=1e-9
    )


def test_the_shear_coefficient_is_the_shapes_unless_it_is_stated():
    beam = beam_of("box")
    assert beam.shear_coefficient is None
    assert beam.shear_correction == beam.section.shear_coefficient(0.3) < 0.5
    assert replace(beam, **SIZES["i"], wall_thickness=None, shape="i").shear_correction < 0.2
    assert replace(beam, shear_coefficient=0.4).shear_correction == 0.4


@pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")
def test_runs_of_rectangles_keep_the_shear_coefficient_unless_the_shape_varies():
    plain = il.simulate_many(
        *(il.paper_impact(), il.Discretisation(nodes=5)),
        duration="1 us",
        varied={"velocity": [1.0, 2.0]},
    )
    assert plain.shear_coefficient == 5 / 6
    box = {"beam_shape": ["box", "tube"], "beam_wall_thickness": ["4 mm"] * 2}
    impact = replace(il.paper_impact(), beam=beam_of("circle"))
    grid = il.Discretisation(nodes=5)
    assert "shear_coefficient" not in il.simulate_many(impact, grid, duration="1 us", varied=box)


WRONG = [
    ("profile", {"profile": None}, r"Beam\.profile = None: must be stated with shape: profile"),
    ("box", {"profile": "0 1, 1 1"}, r"Beam\.profile = '0 1, 1 1': must be left out"),
    ("profile", {"profile": "0 1; 1 1"}, r"Beam\.profile = .*: must be pairs of distance"),
    ("profile", {"profile": "0 1"}, r"Beam\.profile = '0 1': must be pairs"),
    ("profile", {"profile": [(0, 1)] * 16 + [(1, 1)]}, r"Beam\.profile = .*: must be pairs .* 16"),
    ("profile", {"profile": "0 1, 0.9 1"}, r"Beam\.profile = .*: must go from distance 0"),
    ("profile", {"profile": "0 1, 0.6 1, 0.5 1, 1 1"}, r"Beam\.profile = .*: must go from"),
    ("profile", {"profile": "0 0, 1 1"}, r"Beam\.profile = .*: must have widths above 0"),
    ("profile", {"profile": "0 0.5, 1 0.9"}, r"Beam\.profile = .*: must have widths above 0"),
    ("profile", {"profile": "0 nan, 1 1"}, r"Beam\.profile = .*: must have widths above 0"),
    ("box", {"wall_thickness": None}, r"Beam\.wall_thickness = None: must be stated.*'box' needs"),
    ("box", {"wall_thickness": 0.015}, r"Beam\.wall_thickness = 0\.015: must be below half of"),
    ("box", {"web_thickness": 1e-3}, r"Beam\.web_thickness = 0\.001: must be left out: shape = 'b"),
    ("circle", {"wall_thickness": 1e-3}, r"Beam\.wall_thickness = 0\.001: must be left out"),
    ("circle", {"width": 0.04}, r"Beam\.width = 0\.04: must be the depth \(0\.03 m\)"),
    ("tube", {"wall_thickness": 0.0}, r"Beam\.wall_thickness = 0\.0: must be above zero"),
    ("i", {"flange_thickness": None}, r"Beam\.flange_thickness = None: must be stated"),
    ("i", {"flange_thickness": 0.015}, r"Beam\.flange_thickness = 0\.015: must be below half of"),
    ("i", {"web_thickness": 0.05}, r"Beam\.web_thickness = 0\.05: must be below the width"),
]


@pytest.mark.parametrize(("shape", "change", "message"), WRONG)
def test_sizes_that_make_no_section_are_refused(shape, change, message):
    with pytest.raises(ValueError, match=rf"^{message}"):
        beam_of(shape, **change)


@pytest.mark.parametrize("shape", FURTHER)
@pytest.mark.parametrize(
    ("varied", "message"),
    [
        ({"contact_compliance": "beam"}, "_compliance = 'beam': must be half_space with a section"),
        ({"contact_compliance": "strip"}, "'strip': must be half_space with a section that is no"),
        ({"contact_prestress": "bending"}, "'bending': must be ignored with a section that is no"),
        ({"beam_model": "solid"}, "= 'solid': must be euler_bernoulli or .* or rigid with a sec"),
    ],
)
def test_what_is_of_rectangles_refuses_other_shapes(shape, varied, message):
    values = {"beam_model": "timoshenko"} | parameters_of(shape) | varied
    with pytest.raises(ValueError, match=rf"^Impact\..*{message}"):
        case_table(*with_values(il.paper_impact(), il.Discretisation(), values), duration=1e-3)


def test_shapes_in_columns_give_the_table_of_single_runs_bit_by_bit():
    rows = [
        parameters_of(shape) for shape in (*SIZES, "box") if shape not in ("profile", "laminate")
    ]
    names = {name for row in rows for name in row}
    varied = {name: [row.get(name) for row in rows] for name in sorted(names)}
    base = il.paper_impact(), il.Discretisation()
    cases = case_table(*base, duration=1e-3, varied=varied)
    alone = [case_table(*with_values(*base, row), duration=1e-3) for row in rows]
    assert cases.tobytes() == np.concatenate(alone).tobytes()
    tables = [fibre_table(case)[0] for case in alone]
    assert fibre_table(cases).tobytes() == np.array(tables).tobytes()
    # of one shape, checked and computed as columns
    values = np.linspace(0.002, 0.004, 5)
    base = with_values(*base, parameters_of("i"))
    many = case_table(*base, duration=1e-3, varied={"beam_flange_thickness": values})
    for case, value in zip(many, values.tolist(), strict=True):
        single = with_values(*base, {"beam_flange_thickness": value})
        assert case.tobytes() == case_table(*single, duration=1e-3)[0].tobytes()


def test_profiles_of_other_shapes_are_these_shapes():
    """The shear coefficient of a rectangle is that of energy, too."""
    for shape, profile in {"rectangle": [(0, 1), (1, 1)], "i": I_PROFILE}.items():
        sizes = {"width": 0.05, "depth": 0.03, "profile": profile}
        section, other = beam_of("profile", **sizes).section, beam_of(shape).section
        for name in ("area", "second_moment", "plastic_modulus", "stress_per_moment"):
            assert getattr(section, name) == pytest.approx(getattr(other, name), rel=1e-13)
        if shape == "rectangle":
            assert section.shear_coefficient(0.3) == pytest.approx(5 / 6, rel=1e-12)
        else:
            for rule in RULES:
                for one, two in zip(section.cut(rule, 9), other.cut(rule, 9), strict=True):
                    assert one == pytest.approx(two, rel=1e-12)
    # a rhombus: tau over the mean is 1 + s - 2 s^2 at the distance s, so k = 30/31
    rhombus = beam_of("profile", profile="0 1, 1 0").section
    assert rhombus.shear_coefficient(0.3) == pytest.approx(30 / 31, rel=1e-12)


I_PROFILE = [(0, 0.04), (11 / 15, 0.04), (11 / 15, 1), (1, 1)]


def test_a_profile_is_no_factor():
    base = replace(il.paper_impact(), beam=beam_of("profile")), il.Discretisation(nodes=5)
    with pytest.raises(ValueError, match="beam_profile: is the same in all runs"):
        case_table(*base, duration=1e-3, varied={"beam_profile": ["0 1, 1 1"]})
    # of which the sizes are
    cases = case_table(*base, duration=1e-3, varied={"beam_depth": [0.02, 0.03]})
    for case, depth in zip(cases, (0.02, 0.03), strict=True):
        single = case_table(*with_values(*base, {"beam_depth": depth}), duration=1e-3)
        assert case.tobytes() == single[0].tobytes()
