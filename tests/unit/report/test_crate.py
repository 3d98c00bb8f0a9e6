"""ro-crate-metadata.json and the metadata of figures: what a folder of results says of itself."""

import hashlib
import json
import shutil
from pathlib import Path
from xml.etree import ElementTree

import pytest
from command_line import done
from PIL import Image
from ruamel.yaml import YAML

from impactlab.files import read_netcdf
from impactlab.report.crate import write_crate

ROOT = Path(__file__).parents[3]


@pytest.fixture
def folder(results, drawn):
    """A study, drawn and reported, and a file of somebody else's; for reading only."""
    folder = drawn.with_name("reported")
    if not folder.exists():
        shutil.copytree(results / "velocity", folder)
        (folder / "notes.txt").write_text("not ours")
        done("figures", "runs.nc", "analysis.nc", cwd=folder)
        done("report", "runs.nc", "analysis.nc", cwd=folder)
    return folder


@pytest.fixture
def graph(folder):
    crate = json.loads((folder / "ro-crate-metadata.json").read_text("utf-8"))
    return {entity["@id"]: entity for entity in crate["@graph"]}


def test_every_file_is_described_with_size_and_hash(folder, graph):
    files = {name for name, entity in graph.items() if entity["@type"] == "File"}
    there = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    assert files == there - {"notes.txt", "ro-crate-metadata.json"}
    assert {"solved_study.yaml", "runs.nc", "report.html", "figures/contact_duration.svg"} <= files
    for name in files:
        content = (folder / name).read_bytes()
        assert graph[name]["contentSize"] == str(len(content))
        assert graph[name]["sha256"] == hashlib.sha256(content).hexdigest()
    assert {entry["@id"] for entry in graph["./"]["hasPart"]} == files
    # it says what made the files
    attrs = read_netcdf(folder / "runs.nc", "runs").attrs
    assert (folder / "solved_study.yaml").read_text("utf-8") == attrs["study_text"]
    assert graph["ro-crate-metadata.json"]["about"] == {"@id": "./"}
    assert graph["./"]["name"] == attrs["title"]
    assert graph["#solve"]["object"] == {"@id": "solved_study.yaml"}
    assert graph["#solve"]["result"] == graph["#report"]["object"] == {"@id": "runs.nc"}
    assert {"@id": "report.html"} in graph["#report"]["result"]
    citation = YAML(typ="safe").load(ROOT / "CITATION.cff")
    software = graph["#impactlab"]
    assert software["version"] == f"{citation['version']} ({attrs['source_revision']})"
    assert graph[software["author"]["@id"]]["name"] == citation["authors"][0]["name"]
    assert graph[software["license"]["@id"]]["name"] == citation["license"]

    # every reference is described
    def references(value):
        if isinstance(value, list):
            return set().union(*map(references, value))
        return {value["@id"]} if isinstance(value, dict) else set()

    outside = {"https://w3id.org/ro/crate/1.1"}
    for entity in graph.values():
        assert references(list(entity.values())) <= graph.keys() | outside


def test_what_lies_elsewhere_is_left_out(folder, tmp_path):
    runs = read_netcdf(folder / "runs.nc", "runs")
    crate = write_crate(runs, tmp_path / "new", folder / "figures", folder / "report.html")
    graph = json.loads(crate.read_text("utf-8"))["@graph"]
    assert [each["@id"] for each in graph if each["@type"] == "File"] == ["solved_study.yaml"]


def test_pictures_name_their_study_and_its_hash(folder):
    attrs = read_netcdf(folder / "runs.nc", "runs").attrs
    source = f"study velocity, SHA-256 of its file: {attrs['study_sha256']}"
    with Image.open(folder / "figures" / "contact_duration.png") as picture:
        title = picture.info["Title"]
        assert picture.info["Source"] == source
    drawing = ElementTree.parse(folder / "figures" / "contact_duration.svg")
    terms = {key: drawing.find(f".//{{http://purl.org/dc/elements/1.1/}}{key}") for key in TERMS}
    assert {key: getattr(found, "text", "") for key, found in terms.items()} == {
        "title": title,
        "source": source,
    }


TERMS = ("title", "source")
