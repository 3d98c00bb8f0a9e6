"""Checks of a verification, made one after the other, and all their findings."""

from __future__ import annotations

import logging
from collections.abc import Sequence

import xarray as xr

from impactlab.solver.jit import SOURCES_HASH
from impactlab.study.progress import Progress
from impactlab.study.schema.study import Verification
from impactlab.variables import provenance
from impactlab.verification.catalogue import run
from impactlab.verification.finding import Outcome
from impactlab.verification.stored import packed

log = logging.getLogger(__name__)


def check(verification: Verification) -> xr.Dataset:
    """Make every check, one after the other, and return findings.nc (verification.stored).

    A check that ends in an error is kept as such, and the others are still made.
    """
    outcomes: list[Outcome] = []
    with Progress(total=len(verification.checks), done=0, what="checks") as progress:
        for name in verification.checks:
            outcomes.append(run(name))
            progress.advance(1, failed=int(outcomes[-1].verdict != "passed"))
    attrs = _attributes(verification) | provenance() | {"kernels_sha256": SOURCES_HASH}
    return packed(outcomes).assign_attrs(attrs)


def failure(outcomes: Sequence[Outcome]) -> str:
    """Return a sentence about the checks that failed; "" where none did."""
    bad = [outcome for outcome in outcomes if outcome.verdict != "passed"]
    if not bad:
        return ""
    reasons = "; ".join(f"{outcome.name}: {_reason(outcome)}" for outcome in bad)
    return f"verification failed in {len(bad)} of {len(outcomes)} checks ({reasons})"


def _reason(outcome: Outcome) -> str:
    if outcome.reason:
        return outcome.reason
    total = len(outcome.finding.comparisons)
    return f"{len(outcome.failures)} of {total} comparisons" if total else "it compared nothing"


def _attributes(verification: Verification) -> dict[str, str]:
    return {
        "study": verification.name,
        "title": verification.title,
        "description": verification.description,
        "study_text": verification.text,
        "study_sha256": verification.sha256,
    }
