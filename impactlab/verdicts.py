"""Verdicts as CF flags: the conclusion of an analysis, one word per number."""

from enum import IntEnum
from typing import Self

import numpy as np
import xarray as xr

from impactlab.types import Floats

TOLERANCE = 0.01  # relative numerical error up to which a response counts as converged
ROUND_OFF = 1e-9
"""Relative difference below which values count as equal: round-off adds up over the time steps."""


class Verdict(IntEnum):
    """A flag with its meaning, numbered from 0: from best to worst, so the worst is the maximum.

    sound: whether numbers under this verdict need no warning beside them.
    """

    sound: bool
    meaning: str

    def __new__(cls, sound: bool, meaning: str) -> Self:
        """Make a member from its soundness and meaning."""
        member = int.__new__(cls, len(cls.__members__))
        member._value_ = len(cls.__members__)
        member.sound = sound
        member.meaning = meaning
        return member


def distinct(outputs: Floats) -> tuple[int, int]:
    """Return the number of distinct values, and of runs with the middle one.

    That is the commonest value, where more than half of the runs share one.
    """
    ordered = np.sort(outputs)
    middle = ordered[ordered.size // 2]
    most = np.searchsorted(ordered, middle, "right") - np.searchsorted(ordered, middle)
    return 1 + int(np.count_nonzero(ordered[1:] != ordered[:-1])), int(most)


def names(kind: type[Verdict]) -> list[str]:
    """Return the flags' names as datasets spell them."""
    return [member.name.lower() for member in kind]


def flagged(codes: xr.DataArray, kind: type[Verdict], long_name: str) -> xr.DataArray:
    """Return codes as an int8 variable with CF flag attributes.

    Beside flag_values and flag_meanings: sound_flags (names that need no warning) and
    flag_descriptions (one line per flag, in words).
    """
    result = codes.astype(np.int8)
    result.attrs = {
        "long_name": long_name,
        "flag_values": np.array([member.value for member in kind], np.int8),
        "flag_meanings": " ".join(names(kind)),
        "sound_flags": " ".join(member.name.lower() for member in kind if member.sound),
        "flag_descriptions": "\n".join(f"{m.name.lower()}: {m.meaning}" for m in kind),
    }
    return result


def verdict_variables(
    codes: xr.DataArray, kind: type[Verdict], axis: str, subject: str
) -> dict[str, xr.DataArray]:
    """Return the variables that hold a verdict on (response, *dims): each, and the worst.

    Returns <axis>_verdict and, on (response), <axis>_summary, the worst over the rest of the grid.
    """
    rest = [dim for dim in codes.dims if dim != "response"]
    return {
        f"{axis}_verdict": flagged(codes, kind, f"verdict on {subject}"),
        f"{axis}_summary": flagged(
            codes.max(rest), kind, f"worst verdict on {subject} over the rest of the grid"
        ),
    }
