"""Steps that do not converge are cut in half, and in the end told."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from impactlab.fem3d.kratos.engine import Engine, engine
from impactlab.fem3d.kratos.run import History, Run
from impactlab.fem3d.solver import quarter_mesh
from impactlab.model.impact import Impact

pytestmark = pytest.mark.kratos


def stubborn(kratos: Engine, failures: set[int]) -> Engine:
    """Kratos whose attempts with these numbers do not converge, whatever they find."""
    attempts = iter(range(1000))

    class Stubborn(kratos.analysis):  # type: ignore[misc, name-defined]
        def SolveSolutionStep(self) -> Any:  # noqa: N802
            return super().SolveSolutionStep() and next(attempts) not in failures

    return replace(kratos, analysis=Stubborn)


def history(impact: Impact, failures: set[int], duration: float = 26e-6) -> History:
    mesh = quarter_mesh(impact, element_size=2e-3, ratio=2.0, coarsest=30e-3)
    kratos = stubborn(engine(1), failures)
    return Run(kratos, mesh, impact, duration=duration, time_step=8e-6, penalty=1e15).go()


@pytest.fixture
def _no_balance(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Run, "_balanced", lambda self: False)


@pytest.mark.usefixtures("_no_balance")
def test_a_step_is_cut_in_half_and_the_others_go_on(impact: Impact) -> None:
    smooth, cut = history(impact, set()).table(), history(impact, {1}).table()
    assert (1e6 * smooth[0]).tolist() == pytest.approx([0.0, 8.0, 16.0, 24.0])
    assert (1e6 * cut[0]).tolist() == pytest.approx([0.0, 8.0, 12.0, 20.0, 28.0])
    force, sphere = 1, 2
    for row in (force, sphere):
        assert cut[row, 2] == pytest.approx(0.5 * (smooth[row, 1] + smooth[row, 2]), rel=0.1)


@pytest.mark.usefixtures("_no_balance")
def test_a_step_that_never_converges_ends_the_run_and_keeps_what_was(impact: Impact) -> None:
    short = history(impact, set(range(1, 1000)))
    assert short.stopped == "Newton's iterations did not converge after 8e-06 s"
    assert len(short.moments) == 2
