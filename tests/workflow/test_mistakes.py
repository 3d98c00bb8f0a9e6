"""A person's mistake ends in one message."""

import re
from importlib.metadata import version
from inspect import Parameter, signature
from pkgutil import resolve_name
from typing import get_type_hints

import pytest
from command_line import CHECKS, SMALL, called, here
from command_line import done as impactlab

from impactlab.cli.app import _COMMANDS
from impactlab.study import engine


def test_help_is_not_cut_short(tmp_path):
    assert not re.search(r"\w\.\.\.", impactlab("--help", cwd=tmp_path).stdout)


def test_help_and_version_by_their_usual_names(tmp_path):
    for command in ((), ("simulate",), ("go",)):
        told = impactlab(*command, "-h", cwd=tmp_path).stdout
        assert told == impactlab(*command, "--help", cwd=tmp_path).stdout
    assert impactlab("--version", cwd=tmp_path).stdout == f"impactlab {version('impactlab')}\n"


def test_a_misspelt_command_names_the_nearest(tmp_path):
    told = called("simulat", cwd=tmp_path).stderr
    assert "there is no command 'simulat'; did you mean 'simulate'?" in told


@pytest.mark.parametrize(
    ("args", "words"),
    [
        (["simulate", "--nodes", "600"], ["nodes", "600", "odd"]),
        (["simulate", "--scheme", "newmark"], ["scheme", "newmark", "leapfrog", "modal"]),
        (["simulate", "--beam-model", "string"], ["--beam-model", "string", "timoshenko", "rigid"]),
        (["simulate", "--contact", "glue"], ["contact", "glue", "hertz", "stronge"]),
        (["simulate", "--velocity", "3 kg"], ["velocity", "3 kg", "m/s"]),
        (["simulate", "--duration", "-1 ms"], ["duration", "-0.001"]),
        (["simulate", "--duration", "1"], ["--duration", "seconds without a unit", "'1 ms'"]),
        (["simulate", "--velocity", "-3"], ["--velocity = -3 m/s: must be above zero"]),
        (["simulate", "--velocity", "6 km/s"], ["--velocity", "above the speed of a bar wave"]),
        (["simulate", "--velocity", "fast"], ["a velocity such as '0.99 m/s', or a number in m/s"]),
        (
            ["simulate", "--beam-model", "rigid", "--scheme", "modal"],
            ["ERROR: scheme = 'modal': beam_model = 'rigid' has 'leapfrog' alone"],
        ),
        (["simulate", "--contact", "herz"], ["did you mean 'hertz'? choose from hertz, stronge"]),
        (["simulate", "--base", "papr"], ["--base = 'papr'", "did you mean 'paper'?"]),
        (["run", "studies/smal.yaml"], ["no such file; did you mean studies/small.yaml?"]),
        (["simulate", "--contact", "modal"], ["'modal' is a value for --scheme"]),
        (
            ["simulate", "--velocity", "1 ms", "--duration", "5 m/s"],
            ["--velocity and --duration are swapped"],
        ),
        (["run", "studies/tabs.yaml"], ["line 8, column 1", "put spaces in the place of tabs"]),
        (["run", "studies/long.yaml"], ["long.yaml: duration = 1: ", "write '1 ms', or '1 s'"]),
        (["simulate", "--plot", "one.doc"], ["--plot", "one.doc", ".svg"]),
        (["run", "studies/none.yaml"], ["studies/none.yaml"]),
        (["run", "studies/checks.yaml"], ["checks.yaml", "impactlab verify"]),
        (["design", "studies/checks.yaml"], ["checks.yaml", "impactlab verify"]),
        (["verify", "studies/small.yaml"], ["small.yaml", "impactlab run"]),
        (["verify", "studies/misspelt.yaml"], ["misspelt.yaml", "checks.0", "half_space"]),
        (["verify", "none.nc"], ["none.nc"]),
        (["figures", "studies/small.yaml"], ["small.yaml", "is a study file"]),
        (["run", "studies/broken.yaml"], ["broken.yaml", "velocty", "velocity"]),
        (["analyse", "studies/small.yaml"], ["studies/small.yaml", "is a study file"]),
        (["report", "none.nc", "none.nc"], ["none.nc"]),
        (["predict", "none.nc", "velocity=1"], ["none.nc"]),
        (["run", "studies/small.yaml", "--scheduler", "tcp://127.0.0.1:9"], ["127.0.0.1:9"]),
    ],
)
def test_mistakes_end_in_one_message(folder, args, words, monkeypatch, capsys):
    (folder / "studies" / "broken.yaml").write_text(SMALL.replace("velocity", "velocty"))
    (folder / "studies" / "misspelt.yaml").write_text(CHECKS.replace("space", "spce"))
    (folder / "studies" / "tabs.yaml").write_text(SMALL.replace("  method", "\tmethod"))
    (folder / "studies" / "long.yaml").write_text(SMALL.replace("1 ms", "1"))
    monkeypatch.chdir(folder)
    monkeypatch.setattr(engine, "_PATIENCE", 1.0)
    assert here(*args) == 1
    said = capsys.readouterr().err
    assert "Traceback" not in said
    for word in words:
        assert word in said, said


def outputs():
    """Yield command, number of required arguments and option of everything that is written."""
    for name, place in _COMMANDS.items():
        command = resolve_name(place)
        hints = get_type_hints(command, include_extras=True)
        defaults = [each.default for each in signature(command).parameters.values()]
        for key, hint in hints.items():
            infos = getattr(hint, "__metadata__", None) or [None]
            if getattr(infos[0], "dir_okay", True) is not getattr(infos[0], "file_okay", True):
                yield pytest.param(
                    name, defaults.count(Parameter.empty), f"--{key}", id=f"{name} --{key}"
                )


@pytest.mark.parametrize(("name", "required", "option"), list(outputs()))
def test_no_file_is_named_for_a_kind_that_it_is_not(tmp_path, name, required, option):
    """All options for files and folders: none takes .csv, and the message says what it takes."""
    done = called(name, *["none"] * required, option, "there.csv", cwd=tmp_path)
    assert done.returncode == 1
    assert re.fullmatch(
        rf"ERROR: {option} = 'there.csv': (is written as .*: its name must end in \..*"
        r"|names a folder of files: leave out \.csv)\n",
        done.stderr,
    )
    assert not any(tmp_path.iterdir())


def test_every_command_that_writes_one_file_is_among_them():
    names = {each.id for each in outputs()}
    writing = "simulate recommend design run refine analyse verify figures report index witness"
    assert names >= {f"{name} --output" for name in writing.split()} | {"simulate --plot"}
