"""One run on the command line, and what a command loads."""

import dataclasses
import inspect

import pytest
import xarray as xr
from command_line import called, succeeded
from command_line import done as impactlab

import impactlab as il
from impactlab.cli.simulate import simulate


def test_simulate_takes_a_scheme(tmp_path):
    one = ("simulate", "--nodes", 101, "--duration", "3 ms")  # before a second, harder contact
    leapfrog, modal = (
        impactlab(*one, "--scheme", scheme, cwd=tmp_path).stdout for scheme in ("leapfrog", "modal")
    )
    assert leapfrog != modal
    assert "11.75 kN" in leapfrog
    assert "11.76 kN" in modal  # 11.760 kN in the limit of many nodes


def test_defaults_are_those_of_python():
    entries = inspect.signature(simulate).parameters
    grid = il.Discretisation()
    assert (entries["nodes"].default, entries["points"].default) == (grid.nodes, grid.points)


def loaded(*args, cwd):
    """The packages that a command loads."""
    ended = succeeded(*args, cwd=cwd, python=("-X", "importtime"))
    lines = [line for line in ended.stderr.splitlines() if line.startswith("import time:")]
    return {line.split("|")[-1].strip().split(".")[0] for line in lines}


HEAVY = {"dask", "distributed", "matplotlib", "netCDF4", "pandas", "pint", "ruamel", "xarray"}
ONE = ("simulate", "--nodes", "11", "--velocity", "99 cm/s")


def test_help_loads_nothing_heavy(tmp_path):
    packages = loaded("--help", cwd=tmp_path)
    assert "typer" in packages
    assert packages.isdisjoint(HEAVY | {"numba", "numpy", "pydantic", "rich", "scipy"})
    # simulate loads no more than it needs
    packages = loaded(*ONE, cwd=tmp_path)
    assert "numba" in packages
    assert packages.isdisjoint(HEAVY)
    assert {"netCDF4", "xarray"} <= loaded(*ONE, "--output", "one.nc", cwd=tmp_path)


def test_only_what_solves_loads_the_compiler(folder):
    assert "numba" not in loaded("design", "studies/small.yaml", cwd=folder)
    impactlab("run", "studies/small.yaml", cwd=folder)
    assert "numba" not in loaded("analyse", "results/small/runs.nc", cwd=folder)


def test_simulate_prints_the_same_with_and_without_a_file(tmp_path):
    alone = impactlab(*ONE, cwd=tmp_path).stdout
    kept = impactlab(*ONE, "--output", "one.nc", cwd=tmp_path).stdout
    assert kept == f"{alone}Histories and fields: one.nc\n"
    assert "peak_force" in alone


@pytest.mark.parametrize("beam_model", ["euler_bernoulli", "rigid"])
def test_simulate_draws_a_picture(tmp_path, beam_model):
    drawn = (*ONE, "--beam-model", beam_model, "--plot", "one.svg")
    assert impactlab(*drawn, cwd=tmp_path).stdout.endswith("Picture: one.svg\n")
    assert "<svg" in (tmp_path / "one.svg").read_text()


@pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")
def test_an_implausible_velocity_is_flagged_everywhere(tmp_path):
    words = "3000 m/s: density velocity²/yield stress"
    told = called("simulate", "--nodes", 11, "--velocity", 3000, cwd=tmp_path)
    assert words in told.stderr
    impact, grid = il.paper_impact(velocity=3000), il.Discretisation(nodes=11)
    with pytest.warns(il.ImplausibleWarning, match=words):
        il.simulate(impact, grid, duration=1e-4)
    with pytest.warns(il.ImplausibleWarning, match=words):
        il.simulate_many(il.paper_impact(), grid, duration=1e-4, varied={"velocity": [1.0, 3e3]})


def test_what_is_missing_is_named_with_its_reason(tmp_path):
    told = impactlab(*ONE, "--duration", "50 us", cwd=tmp_path).stdout
    told = " ".join(told.split())
    assert "the first contact does: contact_duration." in told
    assert "--duration = 50 µs is too short for" in told
    # the default duration gives every response
    told = impactlab("simulate", "--nodes", 51, cwd=tmp_path).stdout
    assert "restitution" in told
    assert "missing" not in told.lower()


def test_simulate_sets_any_parameter_of_a_study(tmp_path):
    one = (*ONE, "--duration", "1 ms")
    options = ("--contact", "mjg", "--nodes", 21)
    assert (
        impactlab(*one, *options, cwd=tmp_path).stdout
        == impactlab(*one, "--set", "contact=mjg", "--set", "nodes=21", cwd=tmp_path).stdout
    )
    impactlab(*one, "--set", "beam_depth=20 mm", "--output", "thin.nc", cwd=tmp_path)
    paper = il.paper_impact()
    thin = dataclasses.replace(paper, beam=dataclasses.replace(paper.beam, depth=0.02))
    with pytest.warns(il.TooShortWarning):
        run = il.simulate(thin, il.Discretisation(nodes=11, points=9), duration="1 ms")
    with xr.open_dataset(tmp_path / "thin.nc") as stored:
        assert stored["peak_force"].item() == run["peak_force"].item()


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ("beam_dept=20 mm", "did you mean 'beam_depth'?"),
        ("contact=herz", "did you mean 'hertz'?"),
        ("nodes=20.5", "--set nodes = '20.5': expected a whole number"),
        ("beam_depth=20 kg", "--set beam_depth = '20 kg'"),
        ("beam_depth=-1 mm", "--set beam_depth = -1 mm: must be above zero"),
        ("beam_depth=20", "20 without a unit is read as 20 m: write '20 mm' if that is meant"),
        ("beam_youngs_modulus=210", "write '210 GPa' if that is meant"),
        ("beam_depth", "expected NAME=VALUE"),
        ("beam_span=1 mm", "beam_depth of the base 'paper': must be below the span"),
        ("element_size=1 mm", "--set element_size: unknown parameter"),
    ],
)
def test_a_setting_that_cannot_be_is_refused_with_its_name(tmp_path, setting, message):
    ended = called(*ONE, "--set", setting, cwd=tmp_path)
    assert ended.returncode in (1, 2)
    assert message in ended.stderr
    assert "Traceback" not in ended.stderr


def test_lengths_that_are_swapped_are_named(tmp_path):
    swapped = ("--set", "beam_depth=780 mm", "--set", "beam_span=28 mm")
    told = called(*ONE, *swapped, cwd=tmp_path).stderr
    assert "--set beam_depth and --set beam_span are swapped" in told
    own = ("--set", "beam_depth=780 mm", "--set", "beam_span=770 mm")
    assert "without a unit" not in called(*ONE, *own, cwd=tmp_path).stderr
