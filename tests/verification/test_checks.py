"""Every check of the catalogue, and each of its comparisons."""

import pytest

from impactlab.verification.catalogue import CATALOGUE


@pytest.mark.parametrize("name", CATALOGUE)
def test_check(name):
    finding = CATALOGUE[name].check()
    assert finding.comparisons
    failing = [
        f"{entry.quantity}, {entry.where}: {entry.ours:.9g} {entry.units}, independently "
        f"{entry.independent:.9g}: {entry.error:.3g} {entry.measure} is beyond {entry.tolerance:g}"
        for entry in finding.comparisons
        if not entry.passed
    ]
    assert not failing, "\n".join(failing)
