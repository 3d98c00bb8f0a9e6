"""Explanations of the bits of `status` and `remarks`, in sentences."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from impactlab.variables import FAILURES, MARKS, RESPONSES, WARNINGS


def explain(runs: Any) -> list[str]:
    """Say in words why responses are missing or doubtful.

    Parameters
    ----------
    runs : xarray.Dataset
        One run of `simulate`, or many: of `simulate_many`, `Study.run` or a file `runs.nc`.

    Returns
    -------
    list of str
        A sentence for each reason that `status` names, then for each warning in `remarks`; of many
        runs with their number. Empty where nothing is missing or doubtful.

    Raises
    ------
    ValueError
        If `runs` has no `status`.

    Examples
    --------
    >>> soft = il.paper_impact("5 m/s", "finite_element")
    >>> run = il.simulate(soft, il.Discretisation(nodes=41), duration="12 ms")
    >>> il.explain(run)
    []
    """
    if "status" not in runs:
        raise ValueError(
            "explain: the dataset has no `status`: take the runs of simulate, simulate_many or "
            "Study.run, not an analysis of them (for which il.answers has sentences)"
        )
    return list(sentences(runs))


def sentences(runs: Any) -> Iterator[str]:
    """Yield what `explain` returns; runs may also be what solver.solve returns."""
    status = np.asarray(runs["status"])
    remarks = np.asarray(runs["remarks"]) if "remarks" in runs else np.zeros(1, int)
    for flag, (bit, reason) in FAILURES.items():
        if number := int(((status & bit) != 0).sum()):
            names = [name for name, entry in RESPONSES.items() if entry.missing == flag]
            names = [name for name in names if name in runs]
            missing = f"missing because {reason}: {', '.join(names)}"
            yield _sentence(number, status.size, missing if names else reason)
    for bits, flags in ((status, MARKS), (remarks, WARNINGS)):
        for bit, text in flags.values():
            if number := int(((bits & bit) != 0).sum()):
                yield _sentence(number, status.size, text)


def _sentence(number: int, runs: int, text: str) -> str:
    """Return a sentence on one run, or on a number of runs."""
    return f"{number:,} of {runs:,} runs: {text}." if runs > 1 else f"{text[0].upper()}{text[1:]}."
