"""Convergence with the integration points over the depth: error against the most points.

The error of a rule need not follow a power of the points once fibres yield, so that no order is
fitted. A rule is judged by its own most points; other rules are other points of the grid.
"""

import numpy as np
import numpy.typing as npt
import xarray as xr

from impactlab.methods.runs import usable
from impactlab.types import Floats
from impactlab.verdicts import ROUND_OFF, TOLERANCE, Verdict, verdict_variables

SAFETY = 3.0
"""Uncertainty over difference to the most points, valid where these at least halve the error."""
_COMMENT = "The most points are the reference: the uncertainty is theirs."
_LONG_NAMES = {
    "points_error": "relative difference to the most integration points",
    "points_uncertainty": "numerical uncertainty with the most integration points",
    "points_needed": "fewest integration points from which on error and uncertainty stay within "
    "tolerance",
}


class PointsVerdict(Verdict):
    """The effect of more integration points on one response at one point of the grid."""

    AT_ROUND_OFF = True, "no number of points changes the value by more than 1e-9"
    CONVERGED = (
        True,
        "three times the difference of the most points to the next fewer is within 1 %",
    )
    UNDETERMINED = False, "a run with the most points or the next fewer is missing"
    NOT_YET_CONVERGED = (
        False,
        "three times the difference of the most points to the next fewer exceeds 1 %",
    )


def analysis(runs: xr.Dataset) -> xr.Dataset:
    """Judge the points convergence of every response at every point of the rest of the grid.

    Returns points_error on (response, *grid dims): |value - reference|/|reference|, NaN where
    either is missing, infinite where only the reference is zero. On (response, *other dims):
    points_uncertainty, points_needed (NaN where not even the most do), points_verdict; beside
    them points_summary (response).
    """
    values = usable(runs).sortby("points")
    reference = values.isel(points=-1, drop=True)
    difference = abs(values - reference)
    against_zero = difference.where(difference.isnull() | (difference == 0), np.inf)
    error = (difference / abs(reference).where(reference != 0)).where(reference != 0, against_zero)
    most_first = error.isel(points=slice(None, None, -1))
    nearest = most_first.isel(points=1, drop=True)
    uncertainty = SAFETY * nearest
    # A missing run ends the stretch of small errors: it is not within anything.
    stays = (most_first + uncertainty <= TOLERANCE).astype(int).cumprod("points") == 1
    codes = xr.full_like(nearest, PointsVerdict.NOT_YET_CONVERGED, np.int8)
    codes = codes.where(uncertainty > TOLERANCE, PointsVerdict.CONVERGED)
    codes = codes.where(~(most_first <= ROUND_OFF).all("points"), PointsVerdict.AT_ROUND_OFF)
    codes = codes.where(nearest.notnull(), PointsVerdict.UNDETERMINED)
    dims = ("response", *runs["status"].dims)
    variables = {
        "points_error": error.sel(points=runs["points"]).transpose(*dims),
        "points_uncertainty": uncertainty,
        "points_needed": error["points"].where(stays).min("points"),
    }
    subject = "convergence with the integration points"
    verdicts = verdict_variables(codes, PointsVerdict, "points", subject)
    dataset = xr.Dataset(variables | verdicts)
    for key, long_name in _LONG_NAMES.items():
        dataset[key].attrs = {"long_name": long_name, "units": "1", "comment": _COMMENT}
    about = f"{SAFETY:g} times the difference to the next fewer, relative to the value."
    dataset["points_uncertainty"].attrs["comment"] = about
    for key in ("points_needed", "points_verdict", "points_summary"):
        dataset[key].attrs |= {"tolerance": TOLERANCE, "comment": _COMMENT}
    return dataset


def numerical_uncertainty(values: npt.ArrayLike) -> Floats:
    """Return how far the value of each number of points may lie from the limit of many points.

    values: in any unit, NaN where a run is missing, (numbers,), most points first. SAFETY times the
    larger of its own difference to the most points and that of the next fewer; infinite for a
    missing run, and for all where one of these two is missing. In the unit of the values.
    """
    f = np.asarray(values, float)
    if f.size < 2 or not np.isfinite(f[:2]).all():
        return np.full(f.shape, np.inf)
    amounts = SAFETY * np.maximum(abs(f - f[0]), abs(f[1] - f[0]))
    return np.where(np.isfinite(f), amounts, np.inf)
