"""The status bits and their names."""

from __future__ import annotations

from impactlab.solver import status
from impactlab.variables import STATUS_FLAGS


def test_every_bit_has_one_name_and_no_two_share_a_bit():
    bits = {name: bit for name, bit in vars(status).items() if name.isupper()}
    bits |= {"STOPPED": 1 << len(bits)}  # of the 3-D model, which has no kernel
    assert {name.upper(): bit for name, (bit, _) in STATUS_FLAGS.items()} == bits
    assert sorted(bits.values()) == [2**power for power in range(len(bits))]
