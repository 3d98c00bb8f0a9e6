"""Seed each fault into a copy of the package, and show what catches it: `make mutants`.

    python tests/mutations/run.py [--checks] [WORD ...]

WORD: only faults whose name has one of these words. --checks: the verification study alone, not the
tests. Prints a Markdown table; ends with an error when a fault is caught by nothing, or does not
fit the source any more.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from faults import FAULTS, Fault

ROOT = Path(__file__).resolve().parents[2]
SUITES = ("tests/unit/model", "tests/unit/solver", "tests/verification")
PATIENCE = 1800
"""Seconds for one fault; a run that never ends counts as caught."""
CHECKS = """
from impactlab.verification.catalogue import CATALOGUE
for name, check in CATALOGUE.items():
    try:
        found = check.check().passed
    except Exception as error:
        found = False
    print("caught" if not found else "passed", name, flush=True)
"""


def main(words: list[str]) -> int:
    """Go through the faults; 0 when each one is caught."""
    only_checks = "--checks" in words
    words = [word.lower() for word in words if not word.startswith("--")]
    chosen = [f for f in FAULTS if not words or any(word in f.name.lower() for word in words)]
    stale = [problem for fault in chosen if (problem := misfit(fault))]
    if stale:
        print(*stale, sep="\n", file=sys.stderr)
        return 2
    print("| fault | checks that fail | first test that fails |\n|---|---|---|")
    if report(Fault("none", "jit.py", "", ""), only_checks):
        print("Something fails without any fault: mend that first.", file=sys.stderr)
        return 2
    caught = [report(fault, only_checks) for fault in chosen]
    return 0 if all(caught) else 1


def misfit(fault: Fault) -> str:
    """Why the fault does not fit the source; "" when it does."""
    times = (ROOT / "impactlab/solver" / fault.file).read_text("utf-8").count(fault.old)
    if times == 1:
        return ""
    return (
        f"{fault.name}: its text is in solver/{fault.file} {times} times, not once; "
        f"put tests/mutations/faults.py right:\n    {fault.old.strip()}"
    )


def report(fault: Fault, only_checks: bool) -> bool:
    """Print the fault's row; whether anything caught it."""
    with tempfile.TemporaryDirectory(prefix="mutant-") as folder:
        copy = Path(folder)
        seed(fault, copy)
        checks = failing_checks(copy)
        test = "not run" if only_checks else first_failing_test(copy)
    print(f"| {fault.name} | {', '.join(checks) or 'none'} | {test or 'none'} |", flush=True)
    return bool(checks) or test not in ("", "not run")


def seed(fault: Fault, copy: Path) -> None:
    """The package and its tests in `copy`, with the fault."""
    skip = shutil.ignore_patterns("__pycache__", ".*")
    for name in ("impactlab", "tests", "docs"):
        shutil.copytree(ROOT / name, copy / name, ignore=skip)
    shutil.copy(ROOT / "pyproject.toml", copy)
    path = copy / "impactlab/solver" / fault.file
    path.write_text(path.read_text("utf-8").replace(fault.old, fault.new), "utf-8")


def failing_checks(copy: Path) -> list[str]:
    """Names of the checks of the verification study that fail."""
    lines = list(output(copy, "-c", CHECKS))
    if not any(line.startswith(("caught", "passed")) for line in lines):
        raise RuntimeError("no check has run:\n" + "\n".join(lines[-20:]))
    return [line.split()[1] for line in lines if line.startswith("caught")]


def first_failing_test(copy: Path) -> str:
    """The first test that fails or breaks; "" when none does."""
    options = ("-x", "-q", "-rfE", "--tb=no", "-p", "no:cacheprovider", "-p", "no:xdist")
    for line in output(copy, "-m", "pytest", *options, *SUITES):
        if line.startswith(("FAILED", "ERROR", "no end")):
            return line.split(" - ")[0].partition(" ")[2].rpartition("/")[2]
    return ""


def output(copy: Path, *words: str) -> Iterator[str]:
    """Lines that a Python run on the copy prints, its compiled kernels being its own."""
    env = os.environ | {
        "PYTHONPATH": str(copy),
        "PYTHONDONTWRITEBYTECODE": "1",
        "NUMBA_CACHE_DIR": str(copy / "numba"),
    }
    try:
        run = subprocess.run(
            [sys.executable, *words],
            cwd=copy,
            env=env,
            text=True,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            timeout=PATIENCE,
        )
    except subprocess.TimeoutExpired:
        yield f"no end within {PATIENCE} s"
        return
    yield from run.stdout.splitlines()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
