"""Labels, values and units as papers print them."""

import numpy as np
import pytest
import xarray as xr

from impactlab.figures import labels, scales, style
from impactlab.figures.labels import display
from impactlab.variables import attributes


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (-0.0125, "−0.0125"),
        (123456.0, "1.235×10⁵"),
        (1e-6, "10⁻⁶"),
        (3.14159e-6, "3.142×10⁻⁶"),
        (0.99996, "1"),
        (99999.9, "10⁵"),
        (20.0, "20"),
        (float("inf"), "∞"),
        (float("nan"), "missing"),
    ],
)
def test_numbers_are_typeset_to_four_digits(value, text):
    assert labels.number(value) == text


def test_listing():
    assert [labels.listing(list(items)) for items in ("", "a", "ab", "abc")] == [
        "",
        "a",
        "a and b",
        "a, b and c",
    ]


def test_setting_shows_values_in_one_unit():
    attrs = attributes("beam_yield_stress")
    stress = xr.DataArray([250e6, 345e6], dims="s", attrs=attrs, name="beam_yield_stress")
    assert labels.setting(stress, [0, 1]) == "yield stress of the beam = 250 and 345 MPa"
    # laws and rules are named as in papers
    laws = xr.DataArray(["jackson_green"], dims="contact", name="contact")
    rules = xr.DataArray(["lobatto"], dims="rule", name="rule")
    assert labels.values(laws, [0]) == ["Jackson and Green"]
    assert labels.values(rules, [0]) == ["Gauss-Lobatto"]
    commas = xr.DataArray(["hertz", "stronge"], dims="contact", name="contact")
    commas.attrs = attributes("contact")
    words = "contact law = “Hertz” and “Stronge, unloading after Wang et al.”"
    assert labels.setting(commas, [0, 1]) == words
    # one value says what it counts
    assert labels.value(xr.DataArray([201], dims="nodes", name="nodes"), 0) == "201 nodes"
    assert labels.value(xr.DataArray([7], dims="run", name="run"), 0) == "run 7"
    assert labels.value(xr.DataArray([0.9], dims="courant", name="courant"), 0) == "0.9"
    # axis of a pure number says so
    assert labels.axis("restitution", "") == "Restitution (–)"


@pytest.mark.parametrize(
    ("units", "values", "shown", "symbol"),
    [
        ("N", [0.0, 52e3], 52.0, "kN"),
        ("N", [0.0, 12.0], 12.0, "N"),
        ("s", [4e-4], 0.4, "ms"),
        ("s", [5e-5], 50.0, "µs"),
        ("m", [0.78], 780.0, "mm"),
        ("m", [3e-5], 30.0, "µm"),
        ("Pa", [345e6], 345.0, "MPa"),
        ("Pa", [210e9], 210.0, "GPa"),
        ("J", [0.0, 2.5], 2.5, "J"),
        ("J", [2.5e-3], 2.5, "mJ"),
        ("N m", [2.5e3], 2.5, "kN m"),
        ("N m", [2.5], 2.5, "N m"),
        ("m s-1", [5.0], 5.0, "m/s"),
        ("m s-2", [5.0], 5.0, "m/s²"),
        ("m-1", [5.0], 5.0, "1/m"),
        ("kg m-3", [7850.0], 7850.0, "kg/m³"),
        ("1", [0.4], 0.4, ""),
        ("furlong", [3.0], 3.0, "furlong"),
    ],
)
def test_value_and_symbol_agree(units, values, shown, symbol):
    found = display(xr.DataArray(values, attrs={"units": units}, name="quantity"))
    assert found.symbol == symbol
    assert found(values)[-1] == pytest.approx(shown)


def test_plastic_strain_is_in_percent():
    found = display(xr.DataArray([0.002], attrs={"units": "1"}, name="peak_plastic_strain"))
    assert (found.symbol, float(found(0.002))) == ("%", pytest.approx(0.2))
    # missing values do not choose the unit
    assert display(xr.DataArray([np.nan, 2e3], attrs={"units": "N"})).symbol == "kN"
    assert display(xr.DataArray([np.nan], attrs={"units": "N"})).symbol == "N"


def test_an_axis_has_one_notation():
    with style.applied():
        _, (ax,) = style.panels(1, columns=1, height=40)
    ax.plot([1, 2], [1e-4, 0.1])
    scales.logarithmic(ax, "y", [1e-4, 0.1])
    written = [ax.yaxis.get_major_formatter()(value, 0) for value in (1e-4, 1e-3, 0.1, 1.0)]
    assert written == ["10⁻⁴", "10⁻³", "10⁻¹", "1"]
    scales.logarithmic(ax, "y", [1e-2, 10.0])
    assert ax.yaxis.get_major_formatter()(0.01, 0) == "0.01"
    scales.linear(ax, "y")
    ticks = ax.yaxis.get_major_formatter().format_ticks
    assert ticks([0.0, 5e-5, 1e-4]) == ["0", "5×10⁻⁵", "10⁻⁴"]
    assert ticks([-0.1, 1e-17, 0.1]) == ["−0.1", "0", "0.1"]
