"""The core does without the wings: they are imported only where they are asked for."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from pkgutil import resolve_name

import pytest

from impactlab import wings

PROGRAM = """
import sys
from pkgutil import resolve_name
from command_line import SMALL, done
from pathlib import Path

Path("study.yaml").write_text(SMALL)
done("run", "study.yaml", "--output", "runs.nc", cwd=".")
done("analyse", "runs.nc", cwd=".")
done("figures", "runs.nc", "analysis.nc", "--output", "figures", cwd=".")
done("report", "runs.nc", "analysis.nc", "--figures", "figures", "--output", "report.html", cwd=".")
print(*(name for name in sys.modules if name.startswith(("impactlab.fem3d", "impactlab.paper"))))
"""


@pytest.mark.slow
def test_a_study_of_beams_imports_nothing_of_the_wings(tmp_path: Path) -> None:
    tests = Path(__file__).parents[1]
    program = f"import sys; sys.path.insert(0, {str(tests)!r})\n{PROGRAM}"
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "report.html").exists()
    assert done.stdout.splitlines()[-1] == ""


@pytest.mark.parametrize(
    "reference",
    [wings.COMPILE, *wings.COMMANDS.values(), *wings.SOLVERS.values(), *wings.SOLID.values()],
)
def test_what_a_wing_adds_is_there(reference: str) -> None:
    assert resolve_name(reference)
