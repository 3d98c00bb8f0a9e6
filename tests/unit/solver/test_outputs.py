"""The bits that runs give, and their names."""

import pytest

from impactlab.solver import outputs
from impactlab.variables import STATUS_FLAGS, WARNINGS

STOPPED = 256
"""Of the 3-D model, which has no kernel."""


@pytest.mark.parametrize("flags", [STATUS_FLAGS, WARNINGS])
def test_every_bit_has_one_name_and_no_two_share_a_bit(flags):
    bits = {name: bit for name, (bit, _) in flags.items()}
    kernels = {name: getattr(outputs, name.upper(), STOPPED) for name in flags}
    assert kernels == bits
    assert len(set(bits.values())) == len(bits)


def test_bits_have_no_gaps():
    bits = {bit for flags in (STATUS_FLAGS, WARNINGS) for bit, _ in flags.values()}
    assert sorted(bits) == [2**power for power in range(len(bits))]


def test_no_bit_of_the_kernels_is_without_a_name():
    public = {name for name in vars(outputs) if name.isupper() and not name.startswith("_")}
    bits = {name for name in public if type(getattr(outputs, name)) is int}
    assert bits == {name.upper() for name in (*STATUS_FLAGS, *WARNINGS)} - {"STOPPED"}
