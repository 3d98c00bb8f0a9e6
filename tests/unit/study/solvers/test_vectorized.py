"""Models that take many runs at once give the answers of those that take one."""

import numpy as np
import pytest

import impactlab as il


def study(function, tmp_path, **stated):
    sampling = il.Delta(
        samples=64, parameters={"a": il.Uniform(1.0, 2.0), "b": il.Uniform(1.0, 2.0)}
    )
    return il.Study(title="Many", function=function, sampling=sampling, results=tmp_path, **stated)


def test_a_table_at_once_gives_the_same_answers(tmp_path):

    def ratio(a, b):
        return {"ratio": a / b, "total": a + b}

    runs = [
        study(function, tmp_path / str(number), responses=["ratio", "total"]).run(workers=1)
        for number, function in enumerate((ratio, il.Function(ratio, vectorized=True)))
    ]
    for name in ("ratio", "total"):
        np.testing.assert_array_equal(runs[0][name], runs[1][name])


def test_responses_of_one_impact_are_refused():
    force = il.Function(lambda run: run.peak_force, vectorized=True)
    with pytest.raises(il.StudyError, match=r"responses\.force.*is vectorized"):
        il.Study(
            title="Force",
            impact=il.paper_impact(),
            duration="1 ms",
            responses={"force": force},
            sampling=il.Grid(parameters={"velocity": [1, 2]}),
        )


@pytest.mark.parametrize(
    ("function", "given"),
    [
        (lambda a, b: 1.0, r"shape \(\)"),
        (lambda a, b: a[1:], "shape"),
        (lambda a, b: a + 1j, "comp"),
    ],
)
def test_an_answer_for_each_run_is_required(function, given, tmp_path):
    many = study(il.Function(function, vectorized=True), tmp_path)
    with pytest.raises(ValueError, match=f"{given}.*one number for each"):
        many.run(workers=1)
