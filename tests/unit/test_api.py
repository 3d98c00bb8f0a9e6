"""A study from Python: the same text, reader, store, checks and errors as the command line."""

import re
from dataclasses import replace
from functools import reduce
from operator import getitem
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pint
import pytest
import xarray as xr
from command_line import here
from ruamel.yaml import YAML

import impactlab as il
from impactlab.figures.catalogue import CATALOGUE as INDEX_FIGURES
from impactlab.files import read_netcdf
from impactlab.methods import METHODS
from impactlab.methods.distributions import ENTRIES, Fixed
from impactlab.methods.entries import Entry
from impactlab.methods.sampling import Sampling
from impactlab.model.parameters import PARAMETERS, flatten
from impactlab.study.schema.readers import read_study
from impactlab.validation.fields import plain

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")

UNITS = pint.UnitRegistry()
ROOT = Path(__file__).parents[2]
STUDIES = [
    path
    for path in sorted((ROOT / "studies").glob("*.yaml"))
    if "\nchecks:" not in path.read_text()
]
GRID = il.Discretisation(nodes=21, points=3)
SAMPLE = il.Sobol(
    base_samples=16,
    seed=1,
    parameters={
        "beam_depth": il.Uniform("26 mm", "29 mm"),
        "beam_yield_stress": il.Normal("345 MPa", "20 MPa"),
    },
)


def small(**others):
    """A study of milliseconds."""
    given = {"title": "Depth", "impact": il.paper_impact(velocity="2 m/s"), "duration": "1 ms"}
    return il.Study(**given | {"discretisation": GRID, "sampling": SAMPLE} | others)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_study_from_sample_to_file(folder):
    """Its report is made by the tests of the pages."""
    study = small(responses=["peak_force"])
    runs = study.run(workers=2)
    assert runs.sizes == {"run": 96}
    assert np.isfinite(runs.peak_force).all()
    indices = il.analyse(runs)
    assert {"total_order", "sensitivity_verdict"} <= set(indices)
    study.to_yaml("studies/depth.yaml")
    again = il.Study.from_yaml("studies/depth.yaml")
    assert again.declared == replace(study.declared, path=again.declared.path)
    assert repr(again) == repr(study)
    assert study.status().done == 96


def test_nothing_is_solved_twice_here_or_by_the_command(folder, monkeypatch):
    study = small()
    first = study.run(workers=1)
    study.to_yaml("studies/depth.yaml")
    monkeypatch.setattr("impactlab.study.execute.solved", None)  # which solves
    again = il.Study.from_yaml("studies/depth.yaml").run(workers=1)
    xr.testing.assert_identical(again.drop_attrs(), first.drop_attrs())
    assert here("run", "studies/depth.yaml", "--workers", "1") == 0
    again = read_netcdf(folder / "results/depth/runs.nc", "runs")
    xr.testing.assert_identical(again.drop_attrs(), first.drop_attrs())


def test_commands_take_over_what_python_has_drawn(folder, monkeypatch):
    sampling = il.Grid(parameters={"velocity": [1, 2, 3]})
    study = small(sampling=sampling, responses=["peak_force"])
    study.run(workers=1)
    study.report()
    files = ["results/depth/runs.nc", "results/depth/analysis.nc"]
    assert here("report", *files) == 0
    tables = {path: path.read_bytes() for path in study.tables("latex")}
    assert [path.name for path in tables] == ["runs.tex", "answers.tex"]
    assert here("export", "depth", "--to", "latex", "--output", "again") == 0
    assert [Path("again", path.name).read_bytes() for path in tables] == [*tables.values()]


@pytest.mark.parametrize("path", STUDIES, ids=lambda path: path.stem)
def test_shipped_studies_are_the_same_from_python(path, folder):
    """The mapping in the file, given as arguments, and the file written from them."""
    keys = YAML(typ="safe", pure=True).load(path.read_text(encoding="utf-8"))
    from_file = il.Study.from_yaml(path).declared
    study = il.Study(**keys, name=path.stem)
    same = {"path": from_file.path, "text": from_file.text}
    assert replace(study.declared, **same) == from_file
    study.to_yaml(path.name)
    again = read_study(path.name)
    assert again == replace(study.declared, path=Path(path.name))
    il.Study.from_yaml(path).to_yaml(folder / path.name)
    assert (folder / path.name).read_bytes() == path.read_bytes()


def test_every_method_and_distribution_has_its_class():
    classes = [getattr(il, name) for name in dir(il) if isinstance(getattr(il, name), type)]
    for base, kinds in ((Sampling, METHODS), (Entry, ENTRIES)):
        public = {kind for kind in classes if issubclass(kind, base)}
        assert public == set(kinds.values()) - {Fixed}


FAR = il.paper_impact()
IMPACTS = [
    replace(FAR, velocity=3.3, contact="hertz", gravity=0.0),
    replace(FAR, sphere=replace(FAR.sphere, mass=1.4), beam_model="timoshenko"),
    replace(FAR, beam=replace(FAR.beam, depth=0.1 + 0.2 - 0.27, shear_coefficient=0.8)),
    replace(
        FAR,
        beam=replace(
            FAR.beam, material=replace(FAR.beam.material, kinematic_hardening_modulus=1e9)
        ),
    ),
]


@pytest.mark.parametrize("impact", IMPACTS)
def test_an_impact_is_the_same_to_the_last_bit_in_the_file(impact):
    grid = il.Discretisation(nodes=31, rule="layers", courant=0.1 + 0.2)
    study = small(impact=impact, discretisation=grid)
    assert study.declared.impact == impact
    assert study.declared.discretisation == grid


@pytest.mark.parametrize("value", [GRID, FAR, il.Discretisation(nodes=201, scheme="leapfrog")])
def test_every_value_of_an_object_is_in_the_file(value):
    """Defaults are stated, too: another version may have others."""
    section = plain(value)
    own, other = (value, il.Discretisation()) if value is FAR else (FAR, value)
    for name, held in flatten(own, other).items():
        root, *path = PARAMETERS[name].path
        if root == ("impact" if value is FAR else "discretisation"):
            assert reduce(getitem, path, section) == held
    assert "base" not in section


@pytest.mark.parametrize(
    ("made", "value"),
    [
        (lambda: il.paper_impact("72 km/h").velocity, 20.0),
        (lambda: il.paper_impact(7200 * UNITS.m / UNITS.hour).velocity, 2.0),
        (lambda: il.Discretisation(courant="90 %").courant, 0.9),
        (lambda: replace(FAR.sphere, radius="3.5 cm").radius, 0.035),
        (lambda: replace(FAR.beam, depth=27.8 * UNITS.mm).depth, 0.0278),
        (lambda: replace(FAR.beam.material, density="7.8 g/cm3").density, 7800.0),
        (lambda: replace(FAR.beam.material, yield_stress="345 MPa").yield_stress, 345e6),
        (lambda: small(duration=2 * UNITS.ms).declared.duration, 2e-3),
        (
            lambda: (
                small(sampling=il.Grid(parameters={"velocity": [1, 2] * UNITS.km / UNITS.hour}))
                .design()
                .velocity[0]
                .item()
            ),
            1 / 3.6,
        ),
    ],
)
def test_quantities_are_numbers_texts_or_pint(made, value):
    assert made() == pytest.approx(value, rel=1e-15)


def many():
    return il.simulate_many(FAR, GRID, duration="0.1 ms", varied={"velocity": [1.0, 2.0]})


@pytest.mark.parametrize(
    ("made", "said"),
    [
        (lambda: il.paper_impact("5 kg"), "Impact.velocity = '5 kg': 'kg' has the wrong dimension"),
        (lambda: il.paper_impact(5 * UNITS.kg), "Impact.velocity = '5.0 kg': 'kg' has the wrong"),
        (lambda: small(duration="1 kg"), "Study: duration = '1 kg': 'kg' has the wrong dimension"),
        (lambda: small(duration=None), "Study: duration: is required"),
        (
            lambda: small(store=object()),
            "Study: store: is of type object, which no study file can hold",
        ),
        (
            lambda: small(sampling=replace(SAMPLE, parameters=["velocity"])),
            "Study: sampling.parameters",
        ),
        (lambda: small(sampling=il.Sobol), "Study: sampling: is of type type, which no study"),
        (lambda: small().run(workers=0), "run.workers = 0: must be a whole number of at least 1"),
        (lambda: il.analyse(many()), "the runs are not those of a study"),
        (lambda: il.plot.run(many()), "run: expected the dataset of one impact"),
        (lambda: small(responses=["force"]), "Study: responses.0 = 'force': unknown response; did"),
        (lambda: small(name="../up"), "Study: name = '../up': its name becomes"),
        (
            lambda: small(sampling=replace(SAMPLE, base_samples=100)),
            "Study: sampling.base_samples = 100: must be a power of two, such as 64 or 128",
        ),
        (
            lambda: small(sampling=il.Grid(parameters={"beam_depht": [1]})),
            "Study: sampling.parameters.beam_depht = [1]: unknown key; did you mean 'beam_depth'",
        ),
        (lambda: il.Study.from_yaml("nowhere.yaml"), "nowhere.yaml: there is no such file"),
        (lambda: small().to_yaml("depth.txt"), "depth.txt: the name of a study file must end"),
        (
            lambda: small(name="unsolved").report(),
            "results/unsolved/runs.nc: there are no runs yet",
        ),
    ],
)
def test_mistakes_name_key_and_value(made, said, folder):
    with pytest.raises(ValueError, match=rf"^{re.escape(said)}"):
        made()


def test_runs_of_another_text_are_not_taken_for_these(folder):
    small(responses=["peak_force"]).run(workers=1)
    with pytest.raises(ValueError, match="holds runs of another study"):
        small(responses=["impulse"]).analyse()


@pytest.fixture
def pyplot(monkeypatch):
    from matplotlib import pyplot

    pyplot.switch_backend("agg")
    yield pyplot
    pyplot.close("all")


def test_a_response_is_drawn_on_the_axes_given(pyplot):
    varied = {"velocity": [1.0, 2.0, 3.0], "contact": ["hertz", "stronge"]}
    runs = il.simulate_many(FAR, GRID, duration=1e-3, varied=varied, combine="product")
    _, (left, right) = pyplot.subplots(1, 2)
    assert il.plot.response(runs, "contact_duration", hue="contact", ax=left) is left
    for line, law in zip(left.lines, varied["contact"], strict=True):
        assert line.get_xdata().tolist() == varied["velocity"]
        expected = 1e3 * runs.contact_duration.sel(contact=law)
        assert line.get_ydata() == pytest.approx(expected.values)
    assert not right.has_data()
    assert il.plot.response(runs.sel(contact="hertz"), "peak_force") is right  # the current axes
    with pytest.raises(ValueError, match=r"differ in contact: first runs.sel\(contact='hertz'"):
        il.plot.response(runs, "peak_force", x="velocity")
    with pytest.raises(ValueError, match=r"^x = 'velocty': unknown x; did you mean 'velocity'\?"):
        il.plot.response(runs, "peak_force", x="velocty")


def test_indices_are_drawn_as_in_the_report(sobol_study, pyplot):
    runs, analysis = sobol_study
    units = [runs[str(name)].attrs["units"] for name in analysis["response"].values]
    analysis = analysis.assign_coords(response_units=("response", units))
    axes = il.plot.sobol(analysis)
    assert pyplot.get_fignums() == [1]
    drawn = INDEX_FIGURES["sobol_indices"].plot(runs, analysis).axes
    assert len(axes) == len(drawn) > 1
    for ours, theirs in zip(axes, drawn, strict=True):
        widths = [[bar.get_width() for bar in ax.patches] for ax in (ours, theirs)]
        assert widths[0] == pytest.approx(widths[1], nan_ok=True)
    _, ax = pyplot.subplots()
    assert il.plot.sobol(analysis, "peak_force", ax=ax) is ax
    with pytest.raises(ValueError, match="holds no morris_mu_star"):
        il.plot.morris(analysis)
    with pytest.raises(ValueError, match=r"^figure = 'shear': unknown figure; choose from"):
        il.plot.figure("shear", runs, analysis)


def test_a_client_of_ones_own_solves_and_stays_open(folder):
    from distributed import Client

    local = {"n_workers": 1, "threads_per_worker": 1, "dashboard_address": ":0"}
    with Client(processes=False, **local) as client:
        runs = small().run(client=client)
        assert client.submit(int, 3).result() == 3
    again = small(results="others").run(workers=1)
    xr.testing.assert_identical(runs.drop_attrs(), again.drop_attrs())
    assert (folder / "others/depth/runs.nc").exists()


def test_notebooks_show_tables_and_texts():
    assert "<td>depth of the beam</td><td>27.8 mm</td>" in FAR._repr_html_()
    html = small(title="a < b")._repr_html_()
    assert html.startswith("<b>a &lt; b</b><br><code>impactlab.Study a_b: 96 runs, results/a_b<")
    assert "beam_depth: {distribution: uniform, low: 26 mm, high: 29 mm}" in html


def test_an_asynchronous_client_is_refused(folder):
    with pytest.raises(ValueError, match=r"^client: is asynchronous"):
        small().run(client=SimpleNamespace(asynchronous=True))
