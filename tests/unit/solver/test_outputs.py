"""The bits that runs give, and their names."""

from impactlab.solver import outputs
from impactlab.variables import STATUS_FLAGS, WARNINGS

STOPPED = 256
"""Of the 3-D model, which has no kernel."""


def test_every_bit_has_one_name_and_there_are_no_gaps():
    """A reason and a remark on the same thing share their bit."""
    named = STATUS_FLAGS | WARNINGS
    bits = {name: bit for name, (bit, _) in named.items()}
    assert {name: getattr(outputs, name.upper(), STOPPED) for name in named} == bits
    assert sorted(set(bits.values())) == [2**power for power in range(len(set(bits.values())))]
    for flags in (STATUS_FLAGS, WARNINGS):
        assert len({bits[name] for name in flags}) == len(flags)
    public = {name for name in vars(outputs) if name.isupper() and not name.startswith("_")}
    kernels = {name for name in public if type(getattr(outputs, name)) is int}
    assert kernels == {name.upper() for name in named} - {"STOPPED"}
