"""The foot of every page: how to cite the software, and what the page was made from."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import xarray as xr
from ruamel.yaml import YAML

_PACKAGE = Path(__file__).parents[1]


@cache
def read_citation() -> dict[str, Any]:
    """Return what CITATION.cff says."""
    file = _PACKAGE / "CITATION.cff"  # in a checkout it is beside the package
    entries: dict[str, Any] = YAML(typ="safe").load(
        file if file.exists() else _PACKAGE.with_name(file.name)
    )
    return entries


def author_name(author: dict[str, str]) -> str:
    """Return the name of a person, or of an organisation."""
    person = f"{author.get('given-names', '')} {author.get('family-names', '')}".strip()
    return person or author["name"]


def how_to_cite() -> str:
    """Return the request of CITATION.cff, and the entry that it asks for."""
    citation = read_citation()
    authors = ", ".join(map(author_name, citation["authors"]))
    title = f"{citation['title']}, version {citation['version']}"
    return f"{' '.join(citation['message'].split())} {authors}: {title}."


def made_from(stored: xr.Dataset) -> str:
    """Return which file and which version of the software made the results in a dataset."""
    attrs = {key: str(value) for key, value in stored.attrs.items()}
    file = attrs.get("study_file", "").replace("../", "") or f"the study {attrs.get('study', '?')}"
    digest = f" (SHA-256 {attrs['study_sha256'][:12]}…)" if "study_sha256" in attrs else ""
    version = attrs.get("versions", "impactlab").split(",")[0]
    revision = f", revision {attrs['source_revision']}" if "source_revision" in attrs else ""
    return f"Made from {file}{digest} by {version}{revision}."
