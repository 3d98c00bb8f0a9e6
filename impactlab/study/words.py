"""Amounts in words."""

from __future__ import annotations

_TIMES = ((365.25 * 86400, "years"), (86400, "days"), (3600, "hours"), (60, "minutes"), (1, "s"))
_BYTES = ((1e15, "PB"), (1e12, "TB"), (1e9, "GB"), (1e6, "MB"), (1e3, "kB"))


def time(seconds: float) -> str:
    """Two digits of the largest unit that fits: 90 s is "1.5 minutes"."""
    for size, unit in _TIMES:
        if seconds >= size:
            return f"{_two_digits(seconds / size)} {unit}"
    return f"{_two_digits(1e3 * seconds)} ms"


def amount(size: float) -> str:
    """Bytes, likewise, in decimal units."""
    for unit, name in _BYTES:
        if size >= unit:
            return f"{_two_digits(size / unit)} {name}"
    return f"{size:.0f} bytes"


def _two_digits(number: float) -> str:
    return f"{float(f'{number:.2g}'):,g}"
