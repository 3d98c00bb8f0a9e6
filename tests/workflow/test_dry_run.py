"""The cost of a study is shown first, and a month of solving needs --force."""

import pytest
from command_line import here

STUDY = """
title: Small
impact: {base: paper, gravity: GRAVITY}
discretisation: GRID
duration: DURATION
sampling: {method: grid, parameters: {velocity: [0.5, 1.0, 2.0]}}
responses: [peak_force]
"""


@pytest.fixture
def impactlab(tmp_path, monkeypatch, capsys):
    """Runs the command line in this process on a study; (exit code, what it printed)."""
    (tmp_path / "studies").mkdir()
    monkeypatch.chdir(tmp_path)

    def run(*args, grid="{nodes: 21, points: 3}", duration="1 ms", gravity=9.81):
        text = STUDY.replace("GRID", grid).replace("DURATION", duration)
        text = text.replace("GRAVITY", str(gravity))
        (tmp_path / "studies" / "some.yaml").write_text(text)
        code = here(*args)
        printed = capsys.readouterr()
        return code, printed.out + printed.err

    return run


def test_a_dry_run_tells_the_cost_and_leaves_nothing(impactlab, tmp_path):
    code, said = impactlab("run", "--dry-run", "--workers", "2", "studies/some.yaml")
    assert code == 0
    for words in ("runs           3", "of one core", "on 2 workers", "memory", "disk", "velocity"):
        assert words in said
    assert "exceeds the limit" not in said
    code, said = impactlab("run", "--dry-run", "studies/some.yaml", grid="{nodes: 1000001}")
    assert code == 0
    assert "exceeds the limit: studies/some.yaml: discretisation.nodes: needs about" in said
    assert [path.name for path in tmp_path.iterdir()] == ["studies"]


def test_a_month_is_not_begun_unless_it_is_forced(impactlab, tmp_path, monkeypatch):
    code, said = impactlab("run", "studies/some.yaml", duration="10000 years")
    assert code == 1
    assert "studies/some.yaml: duration: needs about" in said
    assert "run it anyway with --force" in said
    assert not (tmp_path / "results").exists()
    begun = []
    monkeypatch.setattr("impactlab.study.steps.solve", lambda *_: begun.append(1) or exit(0))
    impactlab("run", "--force", "studies/some.yaml", duration="10000 years")
    assert begun


def test_a_discretisation_that_is_sought_is_not_sought(impactlab, tmp_path):
    _, said = impactlab("run", "--dry-run", "studies/some.yaml", grid="auto")
    assert "auto: pilot runs will determine it" in said
    assert not (tmp_path / "results").exists()


def test_a_design_costs_what_its_study_does(impactlab, tmp_path):
    impactlab("design", "studies/some.yaml")
    _, stored = impactlab("run", "--dry-run", "results/some/design.nc")
    _, told = impactlab("run", "--dry-run", "studies/some.yaml")
    assert stored.splitlines()[0] == told.splitlines()[0] == "runs           3"
    assert [path.name for path in (tmp_path / "results" / "some").iterdir()] == ["design.nc"]


def test_an_implausible_value_gives_a_warning(impactlab):
    _, said = impactlab("run", "--dry-run", "studies/some.yaml")
    assert "WARNING" not in said
    _, said = impactlab("run", "--dry-run", "studies/some.yaml", grid="{nodes: 21}", gravity=9810)
    assert "WARNING: studies/some.yaml: impact.gravity: 9810 m/s2 is implausible" in said
