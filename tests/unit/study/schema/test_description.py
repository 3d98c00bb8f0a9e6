"""Descriptions of study files for a workflow: what a study is, not which words its file has."""

import pytest

from impactlab.study.schema.readers import describe

GRID = """
title: Small  # no auto here, nor until: or solid
impact: {base: paper}
discretisation: {nodes: 21, points: 3}
duration: 1 ms
sampling:
  method: grid
  parameters:
    velocity: [0.5, 1.0]
"""
SAMPLE = """
title: Sample
impact: {base: paper}
discretisation: {auto: {tolerance: 5 %}}
duration: 1 ms
sampling:
  method: sobol
  base_samples: 64
  until: {interval: 0.1, runs: 1000}
  parameters:
    velocity: {distribution: uniform, low: 1, high: 2}
    beam_depth: {distribution: uniform, low: 26 mm, high: 29 mm}
"""
FUNCTION = """
title: Test function
function: ishigami
sampling:
  method: sobol
  base_samples: 16
  parameters:
    x1: {distribution: uniform, low: -3, high: 3}
    x2: {distribution: uniform, low: -3, high: 3}
    x3: {distribution: uniform, low: -3, high: 3}
"""
EXPECTED = {
    "grid": (GRID, []),
    "sample": (SAMPLE, ["growing", "auto", "sample", "sobol"]),
    "morris": (
        SAMPLE.replace("sobol", "morris")
        .replace("base_samples: 64", "trajectories: 16")
        .replace("  until: {interval: 0.1, runs: 1000}\n", ""),
        ["auto", "sample"],
    ),
    "placed": (
        SAMPLE.replace("sobol", "pawn")
        .replace("base_samples: 64", "samples: 100")
        .replace("interval: 0.1", "coefficient_of_variation: 0.1")
        + "limits: {peak_force: 9 kN}\n",
        ["growing", "auto", "sample"],
    ),
    "fem3d": (
        GRID.replace("{base: paper}", "{base: paper, beam_model: solid}").replace(
            "points: 3", "points: 3, element_size: 2 mm"
        )
        + "responses: [peak_force]\n",
        ["fem3d"],
    ),
    "function": (FUNCTION, []),
    "checks": ("title: Checks\nchecks: [half_space]\n", ["checks"]),
}


@pytest.mark.parametrize(("text", "traits"), EXPECTED.values(), ids=EXPECTED.keys())
def test_traits_are_those_of_the_study(tmp_path, text, traits):
    file = tmp_path / "some.yaml"
    file.write_text(text)
    found = describe(file)
    assert "error" not in found
    assert found["name"] == "some"
    assert found["traits"] == traits
    assert found["title"] == text.split("title: ")[1].splitlines()[0].partition("  #")[0]


def test_a_wrong_file_has_no_traits_and_says_why(tmp_path):
    file = tmp_path / "wrong.yaml"
    file.write_text(GRID.replace("nodes: 21", "nodes: many"))
    found = describe(file)
    assert found["traits"] == []
    assert "discretisation.nodes" in found["error"]
