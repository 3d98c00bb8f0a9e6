from __future__ import annotations

import hashlib

import pytest

from impactlab.study.declaration import Study, Verification, read_any, read_study, read_verification
from impactlab.study.errors import StudyError
from impactlab.verification.catalogue import CATALOGUE

TEXT = "title: Checks\nchecks: [half_space]\n"


@pytest.fixture
def file(tmp_path):
    """Writes a study file."""

    def write(text, name="some.yaml"):
        path = tmp_path / name
        path.write_text(text)
        return path

    return write


def said(read, path):
    with pytest.raises(StudyError) as caught:
        read(path)
    return str(caught.value)


def test_a_list_of_checks(file):
    path = file(TEXT)
    read = read_verification(path)
    assert (read.name, read.path, read.text) == ("some", path, TEXT)
    assert (read.title, read.description) == ("Checks", "")
    assert read.checks == ("half_space",)
    assert read.size == "1 check"
    assert read.sha256 == hashlib.sha256(TEXT.encode()).hexdigest()


def test_all_checks_in_the_order_of_the_catalogue(file):
    assert read_verification(file("title: x\nchecks: all\n")).checks == tuple(CATALOGUE)


def test_the_key_checks_tells_the_kinds_apart(file, grid):
    assert isinstance(read_any(file(TEXT)), Verification)
    assert isinstance(read_any(file(grid())), Study)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("title: x\nchecks: [half_spce]\n", "checks.0 = 'half_spce': unknown check; did you mean"),
        ("title: x\nchecks: [half_space, half_space]\n", "names half_space more than once"),
        ("title: x\nchecks: []\n", "checks = []: expected `all`, or a list of names"),
        ("title: x\nchecks: some\n", "checks = 'some': expected `all`, or a list of names"),
        ("title: x\nchecks:\n", "checks = null: expected `all`, or a list of names"),
        ("title: x\nchecks: all\nduration: 1 ms\n", "duration = '1 ms': unknown key"),
        ("titel: x\nchecks: all\n", "titel = 'x': unknown key; did you mean 'title'?"),
        ("checks: all\n", "title: is required"),
        ("title: x\ncheck: all\n", "check = 'all': unknown key; did you mean 'checks'?"),
        ("title: x\nchecks: all\nchecks: all\n", 'duplicate key "checks"'),
    ],
)
def test_mistakes_name_file_and_key(file, text, words):
    path = file(text)
    for read in (read_any, read_verification):
        told = said(read, path)
        assert words in told
        assert all(line.startswith(f"{path}: ") for line in told.splitlines())


def test_all_mistakes_are_told_at_once(file):
    told = said(read_any, file("titel: x\nchecks: [half_spce]\n"))
    assert len(told.splitlines()) == 3


def test_the_other_kind_is_sent_to_its_command(file, grid):
    checks, runs = file(TEXT, "checks.yaml"), file(grid(), "runs.yaml")
    assert f"use `impactlab verify {checks}`" in said(read_study, checks)
    assert f"use `impactlab run {runs}`" in said(read_verification, runs)
