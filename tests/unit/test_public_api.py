"""Names, stubs and examples of `import impactlab`."""

import doctest
import pydoc
import re
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path
from types import ModuleType

import pytest

import impactlab as il

ROOT = Path(__file__).parents[2]
PUBLIC = [name for name in dir(il) if not isinstance(getattr(il, name), ModuleType)]
PLOTS = [f"plot.{name}" for name in il.plot.__all__]


def found(name):
    for step in name.split("."):
        owner = getattr(locals().get("owner", il), step)
    return owner


@pytest.mark.parametrize("name", ["__doc__", *PUBLIC, *PLOTS])
def test_examples_of_public_names_run(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    from matplotlib import pyplot

    pyplot.switch_backend("agg")
    thing = il if name == "__doc__" else found(name)
    options = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE | doctest.IGNORE_EXCEPTION_DETAIL
    runner = doctest.DocTestRunner(verbose=False, optionflags=options)
    examples = doctest.DocTestFinder(recurse=name != "__doc__").find(thing, name, globs={"il": il})
    for each in examples:
        runner.run(each)
    pyplot.close("all")
    assert runner.summarize(verbose=False).failed == 0
    assert runner.tries > 0, f"{name} has no example"


def test_the_package_names_its_public_names_and_version():
    assert il.__version__ == version("impactlab")
    stub = (ROOT / "impactlab" / "__init__.pyi").read_text(encoding="utf-8")
    assert dir(il) == sorted(re.findall(r"import \w+ as (\w+)", stub))
    assert set(dir(il)) <= set(re.findall(r"\w+", il.__doc__))
    # help fits two screens and the public names come first
    told = pydoc.plain(pydoc.render_doc(il))
    assert told.count("\n") < 90
    assert told.index("load_surrogate") < told.index("PACKAGE CONTENTS")


def test_importing_the_package_loads_nothing_heavy():
    heavy = {"numba", "xarray", "dask", "matplotlib", "pydantic", "scipy", "impactlab.api"}
    command = f"import sys, impactlab; print(sorted({heavy!r} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", command], capture_output=True, text=True)
    assert done.stdout == "[]\n", done.stderr
