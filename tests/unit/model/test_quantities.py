import math
import re
import subprocess
import sys
from decimal import Decimal
from itertools import product
from time import perf_counter

import pytest

from impactlab.model import quantities
from impactlab.model.parameters import PARAMETERS
from impactlab.model.quantities import (
    KINDS,
    UNITS,
    amount,
    duration,
    engineering,
    si,
    si_units,
    time,
    whole,
)
from impactlab.variables import VARIABLES


@pytest.mark.parametrize(
    ("written", "units", "number"),
    [
        ("27.8 mm", "m", 0.0278),
        ("27.8mm", "m", 0.0278),
        ("1 inch", "m", 0.0254),
        ("5 µm", "m", 5e-6),
        ("345 MPa", "Pa", 345e6),
        ("345 N/mm2", "Pa", 345e6),
        ("3.6 km/h", "m s-1", 1.0),
        ("9.81 m/s/s", "m s-2", 9.81),
        ("9.81 m s^-2", "m s-2", 9.81),
        ("9.81 m·s⁻²", "m s-2", 9.81),
        ("7.8 g/cm3", "kg m-3", 7800.0),
        ("7.8 g / cm**3", "kg m-3", 7800.0),
        ("12 ms", "s", 0.012),
        ("30 %", "1", 0.3),
        ("0.99", "m s-1", 0.99),
        ("1e-3", "s", 1e-3),
        ("-.5e1 m", "m", -5.0),
        (" 2 m ", "m", 2.0),
        (0.0278, "m", 0.0278),
        (1, "m", 1.0),
    ],
)
def test_what_is_written_becomes_exactly_this_si_number(written, units, number):
    assert si(written, units) == number


def test_units_leave_no_trace_of_binary_rounding():
    for tenths in range(1, 1000, 7):
        assert si(f"{tenths / 10} mm", "m") == float(f"{tenths}e-4")


@pytest.mark.parametrize("target", [units for units in KINDS if units != "1"])
def test_known_units_are_what_pint_says(target):
    """To the last bit, and with the same dimension."""
    compared = 0
    names = [*UNITS, *(f"{one}/{other}" for one, other in product(UNITS, UNITS)), "g/cm3", "m/s2"]
    names += ["s-1", "N m", "kN m"]
    for name, number in product(names, ("-27.8e-7", "123456789.123456789")):
        try:
            expected = quantities._by_pint(Decimal(number), name, target)
        except ValueError as error:
            with pytest.raises(ValueError, match=re.escape(str(error))):
                si(f"{number} {name}", target)
        else:
            assert si(f"{number} {name}", target) == expected, name
            compared += 1
    assert compared >= 2


def test_units_of_most_studies_do_without_pint():
    code = """
import sys
from impactlab.model.quantities import KINDS, si
for units, (_, example) in KINDS.items():
    si(example, units)
assert "pint" not in sys.modules
assert si("1 inch", "m") == 0.0254
assert "pint" in sys.modules
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("written", "units", "words"),
    [
        ("5 kg", "m", "'kg' has the wrong dimension; expected a length such as '27.8 mm'"),
        ("5 mm", "Pa", "expected a stress such as '345 MPa', or a number in Pa"),
        ("20 degC", "m", "wrong dimension"),
        ("20 °C", "1", "wrong dimension"),
        ("3 rad", "1", "wrong dimension"),
        ("3 %", "m", "wrong dimension"),
        ("5 Mpa", "Pa", "unknown unit 'Mpa'"),
        ("5 nan", "m", "unknown unit 'nan'"),
        ("fast", "m s-1", "cannot be read as one number and one unit"),
        ("", "m", "cannot be read"),
        ("nan", "m", "cannot be read"),
        ("inf m", "m", "cannot be read"),
        ("3,5 mm", "m", "cannot be read"),
        ("1 m + 1 m", "m", "cannot be read"),
        ("2 * 3 m", "m", "cannot be read"),
        ("3 m/s s", "m s-1", "cannot be read"),
        ("1" * 200, "m", "cannot be read"),
        ("1e999 m", "m", "must be finite"),
        (math.nan, "m", "must be finite"),
        (-math.inf, "m", "must be finite"),
        (10**400, "m", "must be finite"),
        (True, "m", "expected a length"),
        (None, "m", "expected a length"),
        ([1.0], "m", "expected a length"),
    ],
)
def test_anything_else_is_refused_with_what_was_expected(written, units, words):
    with pytest.raises(ValueError, match=re.escape(words)):
        si(written, units)


@pytest.mark.parametrize(
    "text", ["1e9**1e9 m", "9**9**9**9 m", "1 m" + "**9" * 20, "1 " + "m*" * 35]
)
def test_expressions_are_refused_without_being_computed(text):
    si("1 inch", "m")  # pint is loaded
    start = perf_counter()
    with pytest.raises(ValueError, match="cannot be read"):
        si(text, "m")
    assert perf_counter() - start < 0.5


@pytest.mark.parametrize(
    ("written", "number"), [(201, 201), (201.0, 201), ("201", 201), ("2e2", 200)]
)
def test_whole_numbers(written, number):
    result = whole(written)
    assert result == number
    assert isinstance(result, int)


@pytest.mark.parametrize("written", [2.5, "2.5", True, None, "x", "3 m", 1e300, math.nan])
def test_what_does_not_count_is_refused(written):
    with pytest.raises(ValueError, match="expected a whole number such as 201"):
        whole(written)


def test_every_unit_that_a_study_can_need_has_words_and_a_true_example():
    needed = {entry.units for entry in PARAMETERS.values()} | {VARIABLES["duration"].units}
    assert needed <= KINDS.keys()
    for units, (_, example) in KINDS.items():
        assert si(example, units) > 0
    # few digits need no power of ten
    assert engineering(154.0, "N", digits=2) == "150 N"


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (0.0021, "2.1 ms"),
        (12.3, "12 s"),
        (90, "1.5 minutes"),
        (7200, "2 hours"),
        (4e9, "130 years"),
    ],
)
def test_times(seconds, words):
    assert time(seconds) == words


@pytest.mark.parametrize(("size", "words"), [(12, "12 B"), (1.26e9, "1.3 GB"), (2e18, "2,000 PB")])
def test_amounts(size, words):
    assert amount(size) == words


@pytest.mark.parametrize(
    ("value", "units", "words"),
    [
        (9.7518e-5, "s", "97.52 µs"),
        (61311.0, "N", "61.31 kN"),
        (999999.0, "N", "1 MN"),
        (154321.0, "N", "154.3 kN"),
        (-8.0254, "N s", "-8.025 N s"),
        (0.72266, "m s-1", "0.7227 m/s"),
        (9.81, "m s-2", "9.81 m/s²"),
        (0.0, "m", "0 m"),
        (3e-13, "J", "0.0003 nJ"),
        (0.1445, "1", "0.1445"),
        (40.4, "s-1", "40.4 1/s"),
    ],
)
def test_quantities_in_engineering_notation(value, units, words):
    assert engineering(value, units) == words


@pytest.mark.parametrize("value", [1, 0.1, "1", "1e3"])
def test_a_long_duration_states_its_unit(value):
    with pytest.raises(ValueError, match="without a unit, and impacts last milliseconds"):
        duration(value)
    assert duration(0.05) == 0.05
    assert duration("1 s") == 1.0


@pytest.mark.parametrize(
    ("given", "units"),
    [
        ("1 mm", "m"),
        ("3 kN", "N"),
        ("2 s-1", "s-1"),
        ("20 degC", "K"),
        ("3 V", "kg m2 s-3 A-1"),
        ("10 %", "1"),
        ("hertz", "1"),
        ("1 foo", "1"),
        (3.0, "1"),
    ],
)
def test_the_si_units_of_a_quantity_are_told(given, units):
    assert si_units(given) == units
    if units != "1":
        assert math.isfinite(si(given, units))
