import time

import pytest
from damaged_studies import exploding

from impactlab.study.schema.readers import read_study
from impactlab.validation.errors import StudyError

NO_STUDY = {
    "nothing": ("", "holds no keys"),
    "list": ("- 1\n", "holds no keys"),
    "words": ("just words", "holds no keys"),
    "open bracket": ("a: [1\n", "is not YAML: line 2"),
    "key twice": ("title: x\ntitle: y\n", 'duplicate key "title"'),
    "python object": ("a: !!python/object/apply:os.system [ls]\n", "has the tag !!python/object"),
    "two documents": ("a: 1\n---\nb: 2\n", "is not YAML"),
    "endless number": ("a: 1" + "0" * 5000, "a: is a number of 5,001 characters"),
    "deep": ("a: " + "[" * 500 + "]" * 500, "nests too deeply"),
    "brackets": ("title: " + "[" * 10_000, "line 1: nests too deeply"),
    "in itself": ("a: &a [*a]\n", "nests too deeply"),
    "aliases": (exploding(12, 10, merged=False), "holds too much"),
    "binary": (b"\xff\xfe\x00", "not text in UTF-8"),
    "large": ("title: " + "x" * 300_000, "larger than 256 KiB"),
}


@pytest.mark.parametrize(("content", "words"), NO_STUDY.values(), ids=NO_STUDY.keys())
def test_what_is_no_study_at_all_is_one_clear_problem(problems, content, words):
    start = time.process_time()
    ((_, said),) = problems(content)
    assert time.process_time() - start < 1
    assert words in said
    assert "some-study_1.yaml: " in said
    assert "\n" not in said


@pytest.mark.parametrize(
    "name", ["two words.yaml", "dot.ted.yaml", "é.yaml", "study.yml", "x" * 101 + ".yaml"]
)
def test_a_study_is_named_by_a_plain_word(problems, grid, name):
    ((_, said),) = problems(grid(), name)
    assert "name" in said


def test_a_file_that_is_not_there_or_a_folder_is_named(tmp_path):
    with pytest.raises(StudyError, match=r"nothing\.yaml: there is no such file"):
        read_study(tmp_path / "nothing.yaml")
    (tmp_path / "folder.yaml").mkdir()
    with pytest.raises(StudyError, match=r"folder\.yaml: is not a file"):
        read_study(tmp_path / "folder.yaml")


@pytest.mark.parametrize("given", ["large", "large.yaml", "elsewhere/large.yaml", "studies/large"])
def test_a_name_leads_to_the_study_of_that_name(given, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(StudyError, match=rf"^{given}: there is no such file$"):
        read_study(given)
    (tmp_path / "studies").mkdir()
    (tmp_path / "studies" / "large.yaml").touch()
    with pytest.raises(StudyError, match=r"no such file; did you mean studies/large\.yaml\?$"):
        read_study(given)


def test_a_file_that_starts_with_a_byte_order_mark(read, grid):
    assert read(b"\xef\xbb\xbf" + grid().encode()).title == "A grid"
