"""Files in docs/stored, of studies that take longer than the site, belong to their study files."""

import json
from pathlib import Path

import pytest

import impactlab as il

ROOT = Path(__file__).parents[2]
STORED = sorted((ROOT / "docs" / "stored").iterdir())


@pytest.mark.parametrize("folder", STORED, ids=lambda folder: folder.name)
def test_stored_answers_are_those_of_the_study_as_it_stands(folder):
    kept = json.loads((folder / "shown.json").read_text(encoding="utf-8"))
    study = il.Study.from_yaml(ROOT / "studies" / f"{folder.name}.yaml")
    told = f"the file has changed: make stored STORED={folder.name}"
    assert kept["study_sha256"] == study.declared.sha256, told
    assert kept["answers"]
    assert {f"{name}.png" for name in kept["figures"]} == {p.name for p in folder.glob("*.png")}
