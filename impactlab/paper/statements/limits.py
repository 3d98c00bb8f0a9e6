"""A strain against a limit, its uncertainty counted."""

from __future__ import annotations

from impactlab.paper.statements.claim import Number, Verdict, holds


def against(found: Number, limit: float, *, below: bool, as_read: bool) -> tuple[Verdict, str]:
    """Verdict and reason on a strain below the limit, or above it; open where U holds the limit.

    as_read: the case is a reading that the paper does not state.
    """
    under, over = found.high < limit, found.low > limit
    if not (under or over):
        why = f"The limit lies within the uncertainty, {100 * found.uncertainty:.2g} %."
        return Verdict.UNKNOWN, why
    side = "below" if under else "above"
    sure = "by more than its uncertainty" if found.uncertainty else "on every grid"
    return holds(under is below, as_read=as_read), f"It lies {side} the limit {sure}."
