"""Whatever is in a study file: a sound study, or errors that name file and key. Nothing else."""

import re
import resource
import signal
from collections import Counter
from contextlib import contextmanager

import pytest
from damaged_studies import VALID, damaged, exploding, raw_bytes, write
from hypothesis import HealthCheck, Phase, given, seed, settings

from impactlab.study.design import design
from impactlab.study.estimate import estimate
from impactlab.study.schema.declarations import FunctionStudy, Verification
from impactlab.study.schema.readers import read_any
from impactlab.study.schema.yaml_file import LARGEST
from impactlab.validation.errors import StudyError

SECONDS = 20
ROOM = 1 << 30
FEW, MANY = 20, 300
"""Files of a kind: 11 kinds."""
_DRAWN = 2000
"""Runs of a study that is drawn, at most: the samplers are not what is tested."""
_WHOLE_FILE = re.compile(
    r"is not YAML: |is not text|holds no keys|holds more than|line \d+: nests too deeply"
    r"|has the tag|a key must be a word"
)


class Hung(BaseException):
    """A file took too long; no handler of Exception takes it for a mistake in the file."""


@contextmanager
def bounded():
    """No more than some seconds, and 1 GiB beyond what there is."""

    def stop(number, frame):
        raise Hung

    before = resource.getrlimit(resource.RLIMIT_AS)
    with open("/proc/self/statm") as numbers:  # noqa: PTH123
        pages = int(numbers.read().split()[0])
    resource.setrlimit(resource.RLIMIT_AS, (pages * resource.getpagesize() + ROOM, before[1]))
    signal.signal(signal.SIGALRM, stop)
    signal.alarm(SECONDS)
    try:
        yield
    finally:
        signal.alarm(0)
        resource.setrlimit(resource.RLIMIT_AS, before)


def outcome(path):
    """Return "refused", or the kind of study, which can be estimated and drawn."""
    with bounded():
        try:
            study = read_any(path)
            assert study.size
            if not isinstance(study, Verification):
                cost = estimate(study, path.parent, workers=2)
                assert cost.seconds >= 0 < cost.memory < float("inf")
                if isinstance(study, FunctionStudy) or (study.auto is None):
                    _ = design(study) if study.sampling.runs <= _DRAWN else None
        except StudyError as error:
            for problem in error.args:
                _check(problem, path)
            return "refused"
    return type(study).__name__


def _check(problem, path):
    line = str(problem)
    assert line.isprintable()
    assert line.startswith(f"{path}: ")
    assert problem.key or _WHOLE_FILE.match(problem.reason), line
    assert len(line) < 1500
    assert "MemoryError" not in line


def fuzz(kind, number, folder, at=0):
    """Read as many drawn files of a kind; how they ended."""
    ends = Counter()

    @seed(at)
    @settings(
        max_examples=number,
        deadline=None,
        database=None,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(raw=raw_bytes if kind == "raw" else damaged(kind))
    def one(raw):
        ends[outcome(write(folder, raw))] += 1

    one()
    return ends


@pytest.mark.parametrize("kind", VALID)
def test_what_is_damaged_was_sound(kind, tmp_path):
    assert outcome(write(tmp_path, VALID[kind].encode())) != "refused"


@pytest.mark.parametrize("kind", [*VALID, "raw"])
def test_some_damaged_files(kind, tmp_path):
    assert fuzz(kind, FEW, tmp_path)["refused"] > 0


@pytest.mark.chaos
@pytest.mark.parametrize("kind", [*VALID, "raw"])
def test_many_damaged_files(kind, tmp_path):
    ends = fuzz(kind, MANY, tmp_path, at=1)
    print(kind, dict(ends))
    assert ends.total() >= MANY
    assert kind == "raw" or len(ends) > 1  # some are sound: damage is not all that is drawn


@pytest.mark.parametrize("merged", [False, True])
@pytest.mark.parametrize(("levels", "width"), [(12, 10), (19, 2), (200, 2)])
def test_aliases_and_merge_keys_that_explode(levels, width, merged, tmp_path):
    assert outcome(write(tmp_path, exploding(levels, width, merged))) == "refused"


PARSED_LONG = {
    "list": "a: [" + "1," * (LARGEST // 2 - 10) + "]",
    "scalar": "title: " + "x" * (LARGEST - 10),
    "number": "duration: " + "9" * (LARGEST - 20),
    "hexadecimal": "duration: 0x" + "f" * (LARGEST - 20),
    "sexagesimal": "%YAML 1.1\n---\nduration: " + "1:" * 100_000 + "1",
    "open": "{[" * (LARGEST // 2 - 2),
    "dashes": "- " * (LARGEST // 2 - 2),
    "bytes": "title: !!binary " + "A" * (LARGEST - 20),
    "key": "0x" + "f" * 5000 + ": 1",
}


@pytest.mark.slow
@pytest.mark.parametrize("text", PARSED_LONG.values(), ids=PARSED_LONG.keys())
def test_texts_as_long_as_may_be(text, tmp_path):
    assert outcome(write(tmp_path, text.encode())) == "refused"
