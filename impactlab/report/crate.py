"""Description of a folder of results and how it was made, as an RO-Crate (version 1.1).

Source: Sefton et al. (2020), RO-Crate Metadata Specification 1.1, doi:10.5281/zenodo.4031327.
"""

import hashlib
import json
import mimetypes
from pathlib import Path
from typing import Any

import xarray as xr

from impactlab.figures.animation import FILE
from impactlab.figures.record import CAPTIONS, listed
from impactlab.files import replaced
from impactlab.report.page import author_name, read_citation

METADATA = "ro-crate-metadata.json"
_STUDY = "solved_study.yaml"
"""Not the study's own name: such a file may be there, and changed since."""
_SPECIFICATION = "https://w3id.org/ro/crate/1.1"
_FILES = {
    "design.nc": "Parameters of all runs",
    "resolution.nc": "Pilot runs that determined the discretisation",
    "refinement.nc": "Runs solved again on finer grids",
    "runs.nc": "Responses of all runs",
    "multifidelity.nc": "Statistics of a slow model by few of its runs",
    "findings.nc": "Comparisons of the solver with independent values",
    "analysis.nc": "Convergence and sensitivity",
    "indices.nc": "Sensitivity indices with intervals",
    "indices.csv": "Sensitivity indices with intervals",
    "distribution.csv": "Distribution of each response, and probabilities of exceeding limits",
    "surrogate.nc": "Surrogates of the responses",
}
_SOLVED = (
    "design.nc",
    "resolution.nc",
    "refinement.nc",
    "runs.nc",
    "multifidelity.nc",
    "findings.nc",
)
Entity = dict[str, Any]


def write_crate(stored: xr.Dataset, folder: Path, figures_folder: Path, report: Path) -> Path:
    """Write ro-crate-metadata.json into a folder of results, and return its path.

    It describes the study file, put there as solved_study.yaml, the stored datasets, figures and
    report, each with size and SHA-256 hash, and the software that made them. What lies outside the
    folder is left out. stored: runs.nc or findings.nc of the folder. Raises OSError where a file
    cannot be read or written.
    """
    study, attrs = folder / _STUDY, stored.attrs
    with replaced(study) as unfinished:
        unfinished.write_bytes(str(attrs["study_text"]).encode())
    named = {study: ("Study file", "")}
    named |= {folder / name: (text, "") for name, text in _FILES.items()}
    captions = listed(figures_folder) if (figures_folder / CAPTIONS).exists() else {}
    for name, entry in captions.items():
        for file in sorted(figures_folder.glob(f"{name}.*")):
            named[file] = (entry["title"], entry["caption"])
    named[figures_folder / CAPTIONS] = ("Captions of the figures", "")
    named[figures_folder / FILE] = ("Animation of the run", "")
    named[report] = ("Report", "")
    named[report.with_name(f"{report.stem}_explorer.html")] = ("Explorer of the surrogates", "")
    files = [
        _file(path, folder, *texts)
        for path, texts in named.items()
        if path.is_file() and path.resolve().is_relative_to(folder.resolve())
    ]
    solved = [study.name, *(name for name in _SOLVED if (folder / name).exists())]
    outputs = [entity["@id"] for entity in files if entity["@id"] not in solved]
    actions = [
        _action("solve", "Design and solution of the runs", solved[:1], solved[1:], attrs),
        _action("report", "Analysis, figures and report", solved[1:], outputs, {}),
    ]
    licence = {
        "@id": "#licence-of-the-results",
        "@type": "CreativeWork",
        "name": "Not stated",
        "description": "Whoever publishes these results names their licence here.",
    }
    title = str(attrs.get("title") or attrs["study"])
    root = {
        "@id": "./",
        "@type": "Dataset",
        "name": title,
        "description": str(attrs.get("description") or title),
        "datePublished": str(attrs["created"]),
        "license": {"@id": licence["@id"]},
        "hasPart": [{"@id": entity["@id"]} for entity in files],
        "mentions": [{"@id": entity["@id"]} for entity in actions],
    }
    metadata = {
        "@id": METADATA,
        "@type": "CreativeWork",
        "conformsTo": {"@id": _SPECIFICATION},
        "about": {"@id": "./"},
    }
    context = [f"{_SPECIFICATION}/context", {"sha256": "https://schema.org/sha256"}]
    graph = [metadata, root, licence, *files, *actions, *_software(attrs)]
    with replaced(folder / METADATA) as unfinished:
        text = json.dumps({"@context": context, "@graph": graph}, indent=1, ensure_ascii=False)
        unfinished.write_text(f"{text}\n", "utf-8")
    return folder / METADATA


def _links(names: list[str]) -> Entity | list[Entity]:
    links = [{"@id": name} for name in names]
    return links[0] if len(links) == 1 else links


def _file(path: Path, folder: Path, name: str, description: str) -> Entity:
    with path.open("rb") as handle:
        digest = hashlib.file_digest(handle, "sha256").hexdigest()
    kind = mimetypes.guess_type(path.name)[0] or "application/yaml"
    entity = {
        "@id": path.resolve().relative_to(folder.resolve()).as_posix(),
        "@type": "File",
        "name": name,
        "encodingFormat": kind,
        "contentSize": str(path.stat().st_size),
        "sha256": digest,
    }
    return entity | ({"description": description} if description else {})


def _action(
    name: str, title: str, inputs: list[str], outputs: list[str], attrs: dict[str, Any]
) -> Entity:
    """Return a step of the software; attrs: provenance of the runs."""
    terms = {"endTime": "created", "description": "processor"}
    return {
        "@id": f"#{name}",
        "@type": "CreateAction",
        "name": title,
        "instrument": {"@id": "#impactlab"},
        "object": _links(inputs),
        "result": _links(outputs),
    } | {key: str(attrs[source]) for key, source in terms.items() if source in attrs}


def _software(attrs: dict[str, Any]) -> list[Entity]:
    """Return the software as it solved the runs, its authors and its licence (CITATION.cff)."""
    citation = read_citation()
    licence = {
        "@id": f"https://spdx.org/licenses/{citation['license']}",
        "@type": "CreativeWork",
        "name": citation["license"],
    }
    authors = []
    for number, entry in enumerate(citation["authors"], 1):
        kind = "Organization" if "name" in entry else "Person"
        place = entry.get("orcid", f"#author-{number}")
        authors.append({"@id": place, "@type": kind, "name": author_name(entry)})
    revision = str(attrs.get("source_revision", ""))
    software = {
        "@id": "#impactlab",
        "@type": "SoftwareApplication",
        "name": citation["title"],
        "description": citation["abstract"],
        "version": f"{citation['version']} ({revision})" if revision else citation["version"],
        "softwareRequirements": str(attrs.get("versions", "")),
        "author": _links([author["@id"] for author in authors]),
        "license": {"@id": licence["@id"]},
    }
    return [software, *authors, licence]
