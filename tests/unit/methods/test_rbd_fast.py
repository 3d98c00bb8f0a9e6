"""RBD-FAST on functions with known first orders, and several indices from one hypercube."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import xarray as xr
from known_indices import INDICES
from numpy.typing import NDArray

import impactlab as il
from impactlab.methods import INDICES as RECORDS
from impactlab.methods import rbd_fast
from impactlab.methods.runs import Sample
from impactlab.report.sensitivity import index_tables

Points = NDArray[np.float64]


def _line(u):
    return np.asarray(u @ [1.0, 2.0, 3.0])


def _product(u):
    return np.asarray((u[:, 0] - 0.5) * (u[:, 1] - 0.5))


def _step(u):
    """Step by 1 over three tenths of x1: variance 0.21, beside a quarter of that of x2."""
    return np.asarray((u[:, 0] > 0.7) + 0.5 * u[:, 1])


_STEP = np.array([0.21, 0.25 / 12, 0.0]) / (0.21 + 0.25 / 12)
CASES: dict[str, tuple[Callable[[Points], Points], Any]] = {
    "ishigami": (INDICES["ishigami"].of_unit, INDICES["ishigami"].first_order),
    "line": (_line, np.array([1, 4, 9]) / 14),
    "interaction alone": (_product, [0.0, 0.0, 0.0]),
    "step": (_step, _STEP),
}


@pytest.mark.parametrize("runs", [64, 512])
@pytest.mark.parametrize("name", CASES)
def test_intervals_cover_the_known_first_orders(name, runs):
    function, exact = CASES[name]
    covered = []
    for seed in range(200):
        rng = np.random.default_rng(seed)
        strata = np.stack([rng.permutation(runs) for _ in range(3)], axis=1)
        unit = (strata + rng.random((runs, 3))) / runs
        columns = {f"x{i}": ("run", column) for i, column in enumerate(unit.T)}
        attrs = {"varied": list(columns), "seed": seed, "method": "rbd_fast"}
        sample = Sample.of(xr.Dataset(coords={"run": np.arange(runs), **columns}, attrs=attrs))
        indices = rbd_fast.INDICES.estimate(function(unit), sample, "y")
        error = np.abs(indices["first_order"] - exact)
        covered.append(error <= indices["first_order_interval"])
    assert np.mean(covered, axis=0).min() >= 0.92


def test_one_hypercube_gives_the_indices_of_each_method(tmp_path):
    """Bit by bit, each with a verdict of its own; the first one named ranks."""
    bounds = {name: il.Uniform(-np.pi, np.pi) for name in ("x1", "x2", "x3")}
    kinds = {
        "delta": il.Delta,
        "hsic": il.Hsic,
        "pawn": il.Pawn,
        "rbd_fast": il.RbdFast,
        "regression": il.Regression,
        "shapley": il.Shapley,
    }

    def analysed(sampling):
        name = type(sampling).__name__
        study = il.Study(
            title=name,
            function="ishigami",
            sampling=sampling,
            analysis={"resamples": 10},
            results=tmp_path,
        )
        runs = study.run(workers=1)
        return runs, il.analyse(runs)

    sampling = il.Latin(
        samples=128,
        indices=["pawn", "regression", "delta", "rbd_fast", "hsic", "shapley"],
        parameters=bounds,
    )
    runs, together = analysed(sampling)
    for name, kind in kinds.items():
        _, alone = analysed(kind(samples=128, parameters=bounds))
        verdict = together[f"{name}_verdict"]
        assert verdict.item() == alone["sensitivity_verdict"].item()
        shared = [key for key in alone.data_vars if "sensitivity" not in str(key)]
        xr.testing.assert_identical(together[shared].drop_attrs(), alone[shared].drop_attrs())
    assert together["sensitivity_verdict"].item() == together["pawn_verdict"].item()
    assert not any("not linear" in sentence for sentence in il.answers(runs, together))
    tables = [
        table for record in runs.attrs["indices"] for table in _tables(runs, together, record)
    ]
    marked = [table.caption for table in tables if "not linear" in table.rows[0][0].detail]
    assert len(marked) == 2
    assert all("Regression" in caption for caption in marked)


def _tables(runs, analysis, name):
    return index_tables(runs, analysis, RECORDS[name].family)
