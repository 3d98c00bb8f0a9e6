"""The measured numbers of a contact law are those of its record."""

import pytest

from impactlab.solver.contact import CONTACT_LAWS, LAWS, LawRecord
from impactlab.verification import law_record

# as test_laws.py, which measures against joints that are known
TOLERANCES = {"yield_pressure": 1e-9, "unloading_start": 1e-6, "jumps": 2e-3, "creates": 5e-3}


@pytest.mark.parametrize("name", LAWS)
def test_the_lines_are_those_of_the_record(name):
    record, fields = CONTACT_LAWS[name], {"name": name, "short": "", "title": "", "source": ""}
    printed = eval(f"dict({''.join(law_record.lines(name))})")
    law = LawRecord(**fields, holds_for="", **printed)
    for number in law_record.NUMBERS:
        expected, tolerance = getattr(record, number), TOLERANCES.get(number, 2e-4)
        if number == "jumps":
            assert len(law.jumps) == len(expected)
            law_jumps, expected = sum(law.jumps, ()), sum(expected, ())
            assert law_jumps == pytest.approx(expected, rel=tolerance)
        else:
            assert getattr(law, number) == pytest.approx(expected, abs=max(tolerance, 1e-5))


def test_a_law_that_is_not_listed():
    with pytest.raises(ValueError, match="did you mean 'hertz'"):
        law_record.lines("herz")
