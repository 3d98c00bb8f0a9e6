"""A number against a limit, its uncertainty counted."""

from __future__ import annotations

from impactlab.analysis.claims.claim import Number, Verdict, holds


def against(found: Number, limit: float, *, below: bool, as_read: bool) -> tuple[Verdict, str]:
    """Verdict and reason on "below the limit" or "above" it; open where the limit is within U."""
    under, over = found.high < limit, found.low > limit
    if not (under or over):
        why = f"The limit lies within the uncertainty of the number ({found.uncertainty:.2g})."
        return Verdict.UNKNOWN, why
    side = "below" if under else "above"
    sure = "by more than" if found.uncertainty else "with"
    amount = "its uncertainty" if found.uncertainty else "nothing left to converge"
    return holds(under is below, as_read=as_read), f"It lies {side} the limit {sure} {amount}."
