"""Statements on contact and flow laws in datasets: attributes of the variables that name them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from impactlab.model.contact_law import LAW_NAMES
from impactlab.model.flow_law import FLOW_LAW_NAMES
from impactlab.solver.contact import CONTACT_LAWS

if TYPE_CHECKING:
    import xarray as xr

OWN = "origin"
"""Attribute of `contact` and `beam_flow_law` on laws from outside the package: source hashes."""
_TEXTS = ("title", "source", "holds_for", "flaws", "unconfirmed", OWN)


def law_texts(contact: xr.DataArray, name: str) -> dict[str, str]:
    """Return what a dataset states of a law, by attribute; else what this process knows.

    contact: the variable. Who reads a report need not have a law from outside.
    """
    if f"{name}: " not in contact.attrs.get(OWN, "") and name in CONTACT_LAWS:
        return {key: getattr(CONTACT_LAWS[name], key, "") for key in _TEXTS}
    texts = dict.fromkeys(_TEXTS, "")
    for key in _TEXTS:
        for line in contact.attrs.get(key, "").splitlines():
            if line.startswith(f"{name}: "):
                texts[key] = line.partition(": ")[2]
    return texts


def describe_laws(dataset: xr.Dataset) -> None:
    """State source, range, flaws and doubts of a dataset's laws, one line per law."""
    if "contact" in dataset.variables:
        laws = [CONTACT_LAWS[name] for name in np.unique(dataset["contact"].values)]
        own = LAW_NAMES.outside([law.name for law in laws])
        for key in _TEXTS if own else _TEXTS[1:]:
            dataset["contact"].attrs |= _lines(key, laws)
    if "beam_flow_law" in dataset.variables:
        own = FLOW_LAW_NAMES.outside(dataset["beam_flow_law"].values)
        for key in _TEXTS:
            dataset["beam_flow_law"].attrs |= _lines(key, own)


def _lines(key: str, laws: Iterable[Any]) -> dict[str, str]:
    """Return an attribute with a line for each law that has this text; {} if none has."""
    lines = [f"{law.name}: {text}" for law in laws if (text := getattr(law, key, ""))]
    return {key: "\n".join(lines)} if lines else {}
