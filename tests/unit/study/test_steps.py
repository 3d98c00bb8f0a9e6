from pathlib import Path

import pytest

from impactlab.solver.jit import SOURCES_HASH
from impactlab.study.schema.declarations import Verification
from impactlab.study.steps import check, failure, removable
from impactlab.verification.catalogue import CATALOGUE
from impactlab.verification.finding import Check, Comparisons, Finding
from impactlab.verification.outcomes import unpacked


def made(name, value):
    """A check of one comparison with 1; a NaN value raises."""

    def check():
        if value != value:
            raise RuntimeError("no value")
        return Finding(Comparisons("b").relative("a", "1", value, 1.0, 0.1))

    return Check(name, "t", "s", check)


@pytest.fixture
def verification(monkeypatch):
    for name, value in {"first": 1.0, "second": float("nan"), "third": 2.0}.items():
        monkeypatch.setitem(CATALOGUE, name, made(name, value))
    checks = ("first", "second", "third")
    return Verification("some", Path("studies/some.yaml"), "Title", "Words", "title: x\n", checks)


@pytest.mark.parametrize("place", ["shards", "calibration/mjg/shards", "calibration/confirming"])
def test_clean_finds_runs_of_a_calibration_too(tmp_path, place):
    studies, results = tmp_path / "studies", tmp_path / "results"
    studies.mkdir()
    folder = results / "mine" / place
    shard = folder / ("a" * 16) / ("b" * 32 + ".nc")
    shard.parent.mkdir(parents=True)
    shard.touch()
    (folder / "lock").touch()
    text = (Path(__file__).parents[3] / "studies" / "smoke.yaml").read_text()
    (studies / "other.yaml").write_text(text)
    with removable(studies, results) as found:
        assert found == {}
    (studies / "mine.yaml").write_text(text)
    with removable(studies, results) as found:
        assert list(found) == [shard]
        assert "another version" in found[shard]


def test_findings_say_where_they_come_from(verification):
    findings = check(verification)
    attrs = findings.attrs
    assert (attrs["study"], attrs["title"], attrs["description"]) == ("some", "Title", "Words")
    assert attrs["study_text"] == "title: x\n"
    assert attrs["study_sha256"] == verification.sha256
    assert attrs["kernels_sha256"] == SOURCES_HASH
    assert {"created", "versions", "source_revision", "processor"} <= attrs.keys()
    # an error does not stop the others
    verdicts = [outcome.verdict for outcome in unpacked(findings)]
    assert verdicts == ["passed", "error", "failed"]


def test_failure_names_what_failed(outcomes):
    told = failure(outcomes)
    assert "failed in 3 of 4 checks" in told
    assert "bad: 3 of 18 comparisons" in told
    assert "broken: ValueError" in told
    assert "void: it compared nothing" in told
    assert "good" not in told
    assert failure(outcomes[:1]) == ""
