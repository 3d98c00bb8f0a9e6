"""Functions of the user: solved, kept and analysed like ours, and never taken for one another."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

import impactlab as il
from impactlab.analysis.measurements import Agreement
from impactlab.figures import access, catalogue, labels
from impactlab.report import measured
from impactlab.report.study import write_report
from impactlab.study.solvers.own import TASKS

SCALE = 1.0
TABLE = object()


def momentum(run):
    return SCALE * run.impulse


MOMENTUM = il.Function(momentum, units="N s")


def work(run):
    """Work of the contact force on the beam, in J."""
    return np.trapezoid(run.contact_force, run.midspan_deflection)


def product(a, b=2.0):
    return a * b


def times(factor):
    return lambda run: factor * run.impulse


SAMPLE = il.Sobol(
    base_samples=8, parameters={"velocity": il.Uniform(1, 2), "beam_depth": il.Uniform(0.02, 0.03)}
)
PLANE = il.Sobol(base_samples=256, parameters={"a": il.Uniform(0, 1), "b": il.Uniform(0, 1)})


def impacts(**others):
    given = {"title": "Own", "impact": il.paper_impact(), "duration": "1 ms", "sampling": SAMPLE}
    return il.Study(**given | {"discretisation": il.Discretisation(nodes=21, points=3)} | others)


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_response_of_ones_own_is_that_of_each_run():
    given = {"momentum": il.Function(momentum, units="N s"), "work": work, "impulse": "impulse"}
    runs = impacts(responses=given).run(workers=2)
    assert set(runs.data_vars) == {*given, "status", "remarks"}
    assert runs.momentum.values.tobytes() == runs.impulse.values.tobytes()
    assert runs.momentum.attrs == {"long_name": "momentum", "units": "N s"}
    ours = impacts(responses=["impulse"], title="Ours").run(workers=2)
    assert runs.impulse.values.tobytes() == ours.impulse.values.tobytes()
    one = runs.isel(run=7)
    beam = il.paper_impact().beam
    impact = il.Impact(
        sphere=il.paper_impact().sphere,
        beam=il.Beam(
            span=beam.span, width=beam.width, depth=one.beam_depth.item(), material=beam.material
        ),
        velocity=one.velocity.item(),
        contact="stronge",
    )
    grid = il.Discretisation(nodes=21, points=3)
    alone = il.simulate(impact, grid, duration=1e-3, samples=1000)
    assert one.work.item() == work(alone)
    assert set(il.analyse(runs).response.values) == set(given)


def peak(run):
    return run.peak_force


PEAK = il.Function(peak)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")
@pytest.mark.parametrize(
    "changes",
    [{"strikes": 2, "strike_interval": "1.5 ms"}, {"further_spheres": "0.25 3 0.0001, 0.75 1 0"}],
)
def test_a_response_of_ones_own_is_that_of_all_strikes_and_spheres(changes):
    impact = replace(il.paper_impact(5.0), **changes)
    grid = il.Discretisation(nodes=21, points=3)
    given = {"momentum": MOMENTUM, "impulse": "impulse"}
    sampling = il.Grid(parameters={"velocity": [4.0, 5.0]})
    runs = impacts(impact=impact, responses=given, sampling=sampling).run(workers=1)
    alone = il.simulate(impact, grid, duration="1 ms", samples=2)
    assert runs.momentum.values.tolist() == runs.impulse.values.tolist()
    assert runs.momentum.values[1] == alone.impulse.item()


@pytest.mark.slow
def test_the_discretisation_is_found_for_own_responses_as_for_ours():
    """One that returns the peak force has its values, uncertainty and recommendation."""
    found = {}
    for name, given in {"own": {"peak": PEAK}, "ours": ["peak_force"]}.items():
        auto = {"tolerance": "5 %", "responses": list(given)}
        study = impacts(
            title=name,
            responses=given,
            duration="0.3 ms",
            sampling=il.Grid(parameters={"velocity": [1, 2]}),
            discretisation={"auto": auto, "scheme": "modal"},
        )
        found[name] = study.run(workers=1), study.recommend(workers=1)
    (own, evidence), (ours, known) = found["own"], found["ours"]
    for axis in ("nodes", "points", "courant"):
        assert own[axis].item() == ours[axis].item()
    assert own.peak.values.tobytes() == ours.peak_force.values.tobytes()
    for name in ("nodes_value", "nodes_uncertainty", "grid_uncertainty", "check_difference"):
        np.testing.assert_array_equal(evidence[name].values, known[name].values)


@pytest.mark.slow
def test_own_responses_are_refined_as_ours():
    given = {"own": {"peak": PEAK}, "ours": ["peak_force"]}
    studies = [
        impacts(title=name, responses=each, duration="0.3 ms") for name, each in given.items()
    ]
    for study in studies:
        study.run(workers=1)
    TASKS.clear()  # as in another process
    own, ours = (study.refine(workers=1, base_samples=4) for study in studies)
    assert {"used", "finer", "more_points"} <= set(own.grid.values)
    np.testing.assert_array_equal(own.peak.values, ours.peak_force.values)
    changes = [study.analyse().total_order_change.values for study in studies]
    np.testing.assert_allclose(*changes, rtol=1e-12)


def test_only_runs_of_a_beam_are_refined_and_only_responses_of_the_study_limited():
    model = il.Study(title="Product", function=product, sampling=PLANE)
    model.run(workers=1)
    with pytest.raises(ValueError, match="its runs are not of a beam model"):
        model.refine(workers=1)
    auto = {"auto": {"responses": ["peak_force"]}}
    with pytest.raises(il.StudyError, match=r"auto.responses: names peak_force, which `responses`"):
        impacts(responses={"peak": PEAK}, discretisation=auto)
    with pytest.raises(il.StudyError, match="python_responses: are given beam runs, which"):
        impacts(
            responses={"peak": peak, "impulse": "impulse"},
            discretisation={"element_size": "1 mm"},
            sampling=il.Grid(parameters={"beam_model": ["timoshenko", "solid"]}),
        )


def test_a_model_of_ones_own_has_its_known_indices():
    """The product of two uniform variables on (0, 1): 3/7 each alone, 4/7 in total."""
    study = il.Study(title="Product", function=product, sampling=PLANE)
    indices = il.analyse(study.run(workers=1))
    assert indices.first_order.values == pytest.approx(3 / 7, abs=0.05)
    assert indices.total_order.values == pytest.approx(4 / 7, abs=0.05)


def units(x, load_2, time):
    return {"energy": load_2 * x, "plastic_strain_of_it": time}


@pytest.mark.parametrize("method", ["grid", "pawn"])
def test_a_model_has_labels_and_units_of_its_own(method):
    """Whatever its parameters are called; the function is given SI numbers."""
    ends = {"x": ("1 mm", "2 mm"), "load_2": ("1 kN", "2 kN"), "time": ("1 ms", "2 ms")}
    given = {"parameters": {name: il.Uniform(*each) for name, each in ends.items()}}
    sampling = il.Pawn(samples=128, **given) if method == "pawn" else il.Grid(parameters=ends)
    of = il.Function(units, units={"energy": "J", "plastic_strain_of_it": "s"})
    responses = ["energy", "plastic_strain_of_it"]
    study = il.Study(title="Units", function=of, responses=responses, sampling=sampling)
    runs = study.run(workers=1)
    assert [runs[name].attrs["units"] for name in (*ends, *responses)] == ["m", "N", "s", "J", "s"]
    assert [runs[name].attrs["long_name"] for name in ends] == ["x", "load 2", "time"]
    assert runs.x.min() >= 0.001
    assert runs.x.max() <= 0.002
    assert (runs.energy == runs.load_2 * runs.x).all()
    assert (runs.plastic_strain_of_it == runs.time).all()
    assert labels.display(runs.plastic_strain_of_it).symbol == "ms"
    assert not access.failed(runs).any()
    assert access.count(runs) == (128 if method == "pawn" else 8)
    assert "comment" not in runs.x.attrs
    shown, curves = (runs.isel(time=0), "load_2") if method == "grid" else (runs, None)
    ax = il.plot.response(shown, "energy", x="x", hue=curves)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("X (mm)", "Energy (J)")


def test_a_returned_array_keeps_its_unit(monkeypatch):
    """Unless arithmetic has touched it, which would pass on N of N * m/s; in threads, too."""
    responses = {"force": lambda run: run.peak_force, "late": lambda run: float("nan")}
    responses["length"] = lambda run: (run.maximum_indentation * 2).assign_attrs(units="m")
    runs = impacts(responses=responses).run(workers=2)
    assert [runs[name].attrs["units"] for name in responses] == ["N", "1", "m"]
    assert xr.get_options()["keep_attrs"] == "default"
    calls = {
        "kept": lambda a: xr.DataArray(a, attrs={"units": "kg m"}),
        "two": lambda a: xr.DataArray(a, attrs={"units": "N" if a < 1.5 else "N m"}),
        "made": lambda a: 2 * xr.DataArray(a, attrs={"units": "N"}),
    }
    sampling = il.Grid(parameters={"a": [1, 2]})
    kept, two, made = (
        il.Study(title=name, function=call, sampling=sampling) for name, call in calls.items()
    )
    assert kept.run(workers=2).value.attrs["units"] == "kg m"
    with pytest.raises(ValueError, match=r"^value: is in N and in N m, depending on the run"):
        two.run(workers=1)
    with pytest.raises(ValueError, match=r"^function: value: gave an array without a unit"):
        made.run(workers=1)


@pytest.mark.parametrize("name", ["run", "response", "parameter", "status"])
def test_names_of_every_dataset_are_refused_before_anything_is_solved(name):
    sampling = il.Grid(parameters={name: [1, 2], "b": [1, 2]})
    reason = "another variable of the results: choose another name"
    with pytest.raises(il.StudyError, match=rf"^Study: sampling.parameters.{name} = .*{reason}"):
        il.Study(title="Taken", function=product, sampling=sampling)
    with pytest.raises(il.StudyError, match=rf"^Study: responses.0 = .*{reason}"):
        il.Study(title="Taken", function=product, responses=[name], sampling=PLANE)


@pytest.mark.parametrize("name", ["x", "b", "time", "mark", "name", "value", "term"])
def test_other_names_are_as_good_as_any(name):
    sampling = il.Grid(parameters={name: [1, 2], "a": [1, 2]})
    call = eval(f"lambda a, {name}: a * {name}")
    study = il.Study(title="Names", function=call, responses=["out"], sampling=sampling)
    runs = study.run(workers=1)
    assert runs.out.dims == (name, "a")
    assert (runs.out == runs.a * runs[name]).all()
    assert runs[name].attrs == {
        "long_name": name,
        "units": "1",
        "function": study.declared.function,
    }
    answer = il.answers(runs, study.analyse())[0]
    assert answer.startswith(f"From 1 to 2 of {name} the out rises from 1 to 2 at 1 of a")


def test_growing_samples_take_functions_too():
    growing = il.Sobol(
        base_samples=64,
        second_order=False,
        parameters=PLANE.parameters,
        until={"interval": 0.1, "runs": 2048},
    )
    runs = il.Study(title="Growing", function=product, sampling=growing).run(workers=1)
    assert 256 < runs.sizes["run"] <= 2048


def of_numbers(velocity, load, contact, nodes=2.0):
    return {"peak_force": velocity * load * contact, "peak_plastic_strain": load + nodes}


def of_words(velocity, load, contact, nodes=2.0):
    return of_numbers(velocity, len(load), 1.0 + (contact == "hertz"), nodes)


NUMBERS = {
    "velocity": il.Uniform("1 mm", "2 mm"),
    "load": il.Uniform(1, 2),
    "contact": il.Uniform(1, 2),
    "nodes": 4.5,
}
WORDS = {"load": il.Choice(["point", "on_top"]), "contact": il.Choice(["hertz", "my_law"])}
GRIDS = {"velocity": ["1 mm", "1.5 mm", "2 mm"], "load": [1, 2], "contact": [1, 2, 3]}
TAKEN = (
    "impact velocity",
    "contact law",
    "contact force",
    "Hertz",
    "mid-span",
    "span of",
    "sphere",
)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("function", "sampling"),
    [
        (of_numbers, il.Sobol(base_samples=64, parameters=NUMBERS)),
        (of_words, il.Sobol(base_samples=256, parameters=NUMBERS | WORDS)),
        (of_numbers, il.Grid(parameters=GRIDS | {"nodes": [3, 5, 9]})),
    ],
    ids=["numbers", "words", "grid"],
)
def test_names_of_impacts_mean_nothing_in_a_model_of_ones_own(folder, function, sampling):
    responses = ["peak_force", "peak_plastic_strain"]
    study = il.Study(title="Names", function=function, responses=responses, sampling=sampling)
    runs = study.run(workers=1)
    analysis = study.analyse()
    assert runs.velocity.attrs["long_name"] == "velocity"
    assert runs.velocity.attrs["units"] == "m"
    assert labels.display(runs.peak_plastic_strain).symbol == ""
    figures = catalogue.applicable(runs, analysis)
    captions = [figure.caption(runs, analysis) for figure in figures.values()]
    assert "contact_laws" not in figures
    assert not any(axis in str(name) for name in analysis for axis in ("nodes", "points"))
    (folder / "captions.json").write_text("{}")
    write_report(runs, analysis, folder, folder / "page.html")
    page = (folder / "page.html").read_text()
    if function is of_numbers and "run" in runs.dims:
        page += (folder / "page_explorer.html").read_text()
    shown = " ".join([*captions, *il.answers(runs, analysis), page])
    assert not [words for words in TAKEN if words in shown]
    name = "scatter_peak_force" if "run" in runs.dims else "parameter_effects"
    axes = il.plot.figure(name, runs, analysis)
    assert "Velocity (mm)" in {axes[0].get_xlabel(), axes[0].figure.get_supxlabel()}
    if function is of_words:
        ticks = axes[2].get_xticklabels()
        assert [tick.get_text() for tick in ticks] == ["hertz", "my law"]
        assert "with hertz" in " ".join(il.answers(runs, analysis))


def test_a_model_of_ones_own_is_compared_with_measurements_of_its_own():
    sampling = il.Grid(parameters={"velocity": ["1 mm", "2 mm"]})
    runs = il.Study(title="Own", function=lambda velocity: 3e3 * velocity, sampling=sampling).run()
    entry = {"quantity": "value", "value": 3.1, "standard_uncertainty": 0.1}
    given = {"title": "Test", "source": "made up", "measurements": [entry]}
    entry["conditions"] = {"velocity": "1 mm"}
    compared = il.compare(runs, given)
    assert compared["compared_verdict"].item() == Agreement.COMPATIBLE
    assert measured._condition(runs, "velocity", 0.001) == "velocity = 1 mm"
    entry["conditions"] = {"velocity": "1 m/s"}
    with pytest.raises(il.StudyError, match="expected a length"):
        il.compare(runs, given)


def test_stored_answers_are_those_of_the_very_function(monkeypatch):
    """A changed global is noticed, an unchanged one solves nothing again."""
    first = impacts(responses={"momentum": MOMENTUM}).run(workers=1)
    with monkeypatch.context() as patch:
        patch.setattr("impactlab.study.execute.solved", None)  # which solves
        again = impacts(responses={"momentum": MOMENTUM}).run(workers=1)
    assert again.momentum.values.tobytes() == first.momentum.values.tobytes()
    study = impacts(responses={"momentum": MOMENTUM})
    monkeypatch.setitem(globals(), "SCALE", 2.0)
    with pytest.raises(ValueError, match=r"momentum@\w+: has changed since the study was built"):
        study.run(workers=1)
    with pytest.raises(ValueError, match="holds the results of another study"):
        impacts(responses={"momentum": MOMENTUM}).run(workers=1)
    doubled = impacts(responses={"momentum": MOMENTUM}).run(workers=1, replace=True)
    assert doubled.momentum.values == pytest.approx(2 * first.momentum.values, nan_ok=True)


@pytest.mark.parametrize(
    ("responses", "said"),
    [
        ({"own": lambda run: TABLE}, "responses.own: its global TABLE is of type object, which"),
        ({"own": times(object())}, "responses.own: its variable factor is of type object, which"),
        ({"own": 3}, "responses.own: is of type int: expected a function"),
        ({"velocity": work}, "responses.velocity: cannot name a response: another variable"),
        ({"peak_force": work}, "responses.peak_force: cannot name a response: another variable"),
        ({"two words": work}, "responses.two words: cannot name a response: use letters"),
    ],
)
def test_functions_that_cannot_be_identified_are_refused_with_the_reason(responses, said):
    with pytest.raises(il.StudyError, match=f"^Study: {said}"):
        impacts(responses=responses)


def test_a_version_of_ones_own_takes_the_place_of_the_fingerprint():
    given = il.Function(lambda run: 0.0 if TABLE else 1.0, version="1")
    assert impacts(responses={"own": given}).run(workers=1).own.values.tolist() == [0.0] * 48


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda run: run.force, "responses.own: raised AttributeError: .* no attribute 'force'"),
        (lambda run: run.contact_force, "responses.own: gave .*, not one real number"),
        (lambda run: "much", "responses.own: gave 'much', not one real number"),
        (lambda run: run.peak_force**2, "responses.own: gave an array without a unit, .*units="),
    ],
)
def test_functions_that_fail_say_which_and_why(call, said):
    with pytest.raises(ValueError, match=f"(?s)^{said}"):
        impacts(responses={"own": call}).run(workers=1)


def test_a_study_of_functions_is_in_no_file():
    study = impacts(responses={"momentum": MOMENTUM})
    with pytest.raises(il.StudyError, match="cannot be written to a file"):
        study.to_yaml("own.yaml")
    (folder := study.folder).mkdir(parents=True)
    (folder / "forged.yaml").write_text(study.declared.text.replace("momentum@", "momentum@0"))
    with pytest.raises(il.StudyError, match="python_responses: holds a Python function"):
        il.Study.from_yaml(folder / "forged.yaml")
