"""The core does without the wings: they are imported only where they are asked for."""

import os
import shutil
import subprocess
import sys
from pathlib import Path
from pkgutil import resolve_name

import pytest

from impactlab import wings

CHECKOUT = Path(__file__).parents[2]
PROGRAM = """
from command_line import SMALL, done
from pathlib import Path

Path("study.yaml").write_text(SMALL)
done("run", "study.yaml", "--output", "runs.nc", cwd=".")
done("analyse", "runs.nc", cwd=".")
done("figures", "runs.nc", "analysis.nc", "--output", "figures", cwd=".")
done("report", "runs.nc", "analysis.nc", "--figures", "figures", "--output", "report.html", cwd=".")
"""
LOADED = """
import sys
rarely = ("impactlab.fem3d.", "impactlab.paper.", "impactlab.study.multifidelity",
          "impactlab.analysis.multifidelity", "impactlab.study.rare_event")
print(*(name for name in sys.modules if name.startswith(rarely)))
"""


def ran(folder, program, package):
    """Return what a program prints that imports impactlab from the folder `package`."""
    paths = [str(package), str(CHECKOUT / "tests")]
    done = subprocess.run(
        [sys.executable, "-c", f"import sys; sys.path[:0] = {paths!r}\n{program}"],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(package)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.long
def test_a_study_of_beams_imports_only_the_records_of_the_wings(tmp_path):
    printed = ran(tmp_path, PROGRAM + LOADED, CHECKOUT)
    assert (tmp_path / "report.html").exists()
    assert printed.splitlines()[-1].split() == ["impactlab.fem3d.wing", "impactlab.paper.wing"]


@pytest.mark.long
def test_the_core_works_without_the_folders_of_the_wings(tmp_path):
    wings_and_caches = shutil.ignore_patterns("fem3d", "paper", "__pycache__")
    shutil.copytree(CHECKOUT / "impactlab", tmp_path / "core/impactlab", ignore=wings_and_caches)
    shutil.copy(CHECKOUT / "CITATION.cff", tmp_path / "core")  # for the report
    printed = ran(tmp_path, f"{PROGRAM}print(done('-h', cwd='.').stdout)", tmp_path / "core")
    assert "report" in printed
    assert not {"paper", "witness"} & set(printed.split())
    assert "Peak force" in (tmp_path / "report.html").read_text("utf-8")


def references():
    """Return all that the records of the wings refer to."""
    models = wings.models().values()
    parts = [reference for model in models for reference in model.references.values()]
    return [*wings.commands().values(), *parts]


@pytest.mark.parametrize("reference", references())
def test_what_a_wing_adds_is_there(reference):
    assert resolve_name(reference)
