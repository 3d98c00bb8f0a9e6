"""Studies side by side: what differs, what it changes, and which studies cannot be compared."""

import shutil

import pytest
from command_line import called, done

import impactlab as il
from impactlab.figures.measures import MORRIS
from impactlab.files import read_netcdf
from impactlab.report.comparison import compare_results
from impactlab.report.results import write_index

ENDS = il.Uniform("-3.14", "3.14")
NAMES = ("late", "early", "middle")
"""Not in the order of their names."""


def solved(folder, name, **keys):
    study = il.Study(name=name, results=folder, **keys)
    study.run(workers=1, replace=True)
    study.analyse()
    (study.folder / "report.html").write_text("a report\n")
    return study


def of_ishigami(folder, name, third, method=il.Sobol, **size):
    size = size or {"base_samples": 256}
    parameters = {"x1": ENDS, "x2": ENDS, "x3": il.Uniform(-third, third)}
    sampling = method(parameters=parameters, **size)
    return solved(folder, name, title=f"To {third}", function="ishigami", sampling=sampling)


def of_velocity(folder, name, **changes):
    keys = {
        "title": name,
        "impact": {"base": "paper", "contact": name},
        "discretisation": il.Discretisation(nodes=21),
        "duration": "1 ms",
        "sampling": il.Grid(parameters={"velocity": [1, 2, 4]}),
        "responses": ["peak_force", "maximum_indentation"],
    }
    return solved(folder, name, **(keys | changes))


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("made") / "results"
    for name, third in zip(NAMES, (3.14, 2, 3), strict=True):
        of_ishigami(folder, name, third)
    of_ishigami(folder, "morris", 3, il.Morris, trajectories=10)
    of_velocity(folder, "hertz")
    of_velocity(folder, "stronge")
    return folder


@pytest.fixture(scope="module")
def told(results):
    """Return the output of the command that compares three samples."""
    return done("compare", *NAMES, "--output", "results/thirds", cwd=results.parent).stdout


def test_samples_are_compared_from_the_command_line(results, told):
    headline, *lines = told.splitlines()
    assert headline.startswith(
        "results/thirds/report.html: From “To 3.14” to “To 3” the share of x"
    ), told
    assert len(lines) <= 4
    page = (results / "thirds" / "report.html").read_text()
    for words in (
        "sampling.parameters.x3.high",
        "Sobol indices side by side",
        "To 3.14",
        "Student",
    ):
        assert words in page
    assert "base_samples" not in page.split('<h2 id="studies-title"')[0]  # the same in all
    for name in NAMES:
        assert f'href="../{name}/report.html"' in page
    stored = read_netcdf(results / "thirds" / "comparison.nc", "comparison")
    assert il.answers(stored)[0] in told
    assert stored["difference"].sizes["pair"] == 3
    figures = {path.stem for path in (results / "thirds" / "figures").glob("*.svg")}
    assert figures == {"lead", "compared_distributions"}


@pytest.mark.usefixtures("told")
def test_the_index_lists_the_studies_in_the_order_of_their_comparison(results):
    write_index(results, results / "index.html")
    page = (results / "index.html").read_text()
    places = [page.index(f'href="{name}/report.html"') for name in ("thirds", *NAMES)]
    assert places == sorted(places)
    assert page.index('href="stronge/report.html"') < places[0]
    # a comparison of other results than those that are there is left out
    shutil.copytree(results, changed := results.parent / "changed")
    of_ishigami(changed, "early", 1)
    write_index(changed, changed / "index.html")
    assert "thirds/report.html" not in (changed / "index.html").read_text()


def test_grids_are_compared_on_common_axes(results):
    comparison = compare_results([results / name for name in ("hertz", "stronge")])
    headline = il.answers(comparison)[0]
    assert headline.startswith("From Hertz to ")
    assert "the peak force falls by up to " in headline
    assert headline.endswith(" at 4 m/s.")
    folder = results / "compare-hertz-stronge"
    page = (folder / "report.html").read_text()
    assert "impact.contact" in page
    table = (folder / "figures" / "compared_responses.csv").read_text()
    assert table.count("Hertz") >= 6
    # of a study of both laws, the runs with the other's law alone
    both = {"contact": ["hertz", "stronge"], "velocity": [1, 2, 4]}
    keys = {"title": "both laws", "impact": {"base": "paper"}}
    of_velocity(results, "both", **keys, sampling=il.Grid(parameters=both))
    comparison = compare_results([results / "both", results / "hertz"])
    assert il.answers(comparison)[0].endswith("the peak force changes by less than 0.1 %.")


def test_methods_other_than_sobol_are_compared_by_their_half_widths(results, tmp_path):
    of_ishigami(results, "wider", 1, il.Morris, trajectories=10)
    comparison = compare_results([results / "morris", results / "wider"], tmp_path / "screened")
    assert "the index of x1 for the value (mean of magnitudes) falls" in il.answers(comparison)[0]
    page = (tmp_path / "screened" / "report.html").read_text()
    assert f"{MORRIS.title} side by side" in page


@pytest.mark.parametrize(
    ("names", "words"),
    [
        (["late"], ["two or more"]),
        (["late", "late"], ["each of them once"]),
        (["late", "hertz"], ["late is a random sample and hertz is a grid", "same kind"]),
        (["late", "eary"], ["no results in results/eary", "did you mean 'early'?"]),
        (["late", "early", "--output", "results/late"], ["choose another folder"]),
    ],
)
def test_what_cannot_be_compared_says_what_to_do(results, names, words):
    ended = called("compare", *names, cwd=results.parent)
    assert ended.returncode == 1
    for word in words:
        assert word in ended.stderr, ended.stderr


def test_studies_without_a_common_response_are_refused(results, tmp_path):
    one = of_velocity(tmp_path, "hertz", responses=["peak_force"])
    other = of_velocity(tmp_path, "mjg", responses=["maximum_indentation"])
    with pytest.raises(ValueError, match="hertz has peak_force; mjg has maximum_indentation"):
        il.compare_studies(one, other)
