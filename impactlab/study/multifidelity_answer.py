"""Verdicts on statistics of a slow model, and the answer in sentences."""

from math import ceil

import numpy as np
import xarray as xr

from impactlab.model.quantities import engineering, time
from impactlab.study.multifidelity_indices import sensitivity
from impactlab.study.multifidelity_prediction import interval_text, prediction_sentence
from impactlab.verdicts import Verdict


class FidelityVerdict(Verdict):
    """Verdicts on statistics of a slow model by runs of a fast one."""

    USABLE = True, "every run has an answer, and the fast model saves slow runs"
    LITTLE_SAVING = True, "the models hardly correlate: slow runs alone do as well"
    MISSING_RUNS = (
        False,
        "runs without an answer, and their pairs, are left out: these may be the extreme ones",
    )
    NO_STATISTICS = False, "too few pairs have answers, or these do not vary"


def answer(result: xr.Dataset) -> str:
    """Return the findings in sentences: first the mean of the response with a limit."""
    limited = np.flatnonzero(np.isfinite(result["limit"].values))
    leading = int(limited[0]) if limited.size else 0
    pairs, runs = int(result["pairs"]), int(result["runs"])
    name = str(result["response"].values[leading]).replace("_", " ")
    mean = stated(result, leading, "mean")
    lines = [
        f"With {result.attrs['high']}, the {name} is {mean} in the mean "
        f"({100 * result.attrs['confidence']:g} % interval), from {pairs:,} of these runs and "
        f"{runs - pairs:,} of the study's."
    ]
    if not mean:
        reason = result["refusal"].values[leading, 0]
        lines = [f"No statistics of the {name} with {result.attrs['high']}: {reason}."]
    for row, response in enumerate(result["response"].values):
        parts = [f"mean {mean}"] if (mean := stated(result, row, "mean")) else []
        if middle := stated(result, row, "median"):
            parts.append(f"median {middle}")
        if spread := stated(result, row, "standard_deviation"):
            parts.append(f"standard deviation {spread}")
        if chance := stated(result, row, "exceedance"):
            units = str(result["response_units"].values[row])
            parts.append(f"above {engineering(float(result['limit'][row]), units)} with {chance}")
        parts.append(f"correlation {float(result['correlation'][row]):.3f}")
        if parts[1:]:
            lines.append(f"{str(response).replace('_', ' ').capitalize()}: {'; '.join(parts)}.")
    if "slow_index" in result:
        lines.append(sensitivity(result, leading))
    if "prediction" in result:
        lines.append(prediction_sentence(result, leading))
    return "\n".join(
        [*lines, *_costs(result, leading, has_mean=bool(stated(result, leading, "mean")))]
    )


def _costs(result: xr.Dataset, leading: int, *, has_mean: bool) -> list[str]:
    """Return what the fast model saves, the best numbers of runs and a caution, in sentences."""
    lines = []
    pairs, runs = int(result["pairs"]), int(result["runs"])
    slow, fast = float(result["slow_seconds"]), float(result["fast_seconds"])
    saving = float(result["saving"].values[leading, 0])
    if has_mean:
        alone, spent = ceil(saving * pairs), pairs * slow + (runs - pairs) * fast
        times = f", about {time(alone * slow)} of one core; both models took {time(spent)}"
        lines.append(
            f"Saving: a mean as accurate takes {alone:,} of the slow runs alone"
            f"{times if slow > 0.0 else ''}."
        )
    if slow > 0.0:
        lines.append(
            f"Allocation: a slow run costs as much as {slow / fast:,.0f} fast ones, and "
            f"{float(result['best_ratio']):,.0f} fast runs per slow one serve the mean best."
        )
    worst = list(FidelityVerdict)[int(result["verdict"])]
    if worst is not FidelityVerdict.USABLE:
        count = int(result["missing"].max())
        most = f" (up to {count} a response)" if worst is FidelityVerdict.MISSING_RUNS else ""
        lines.append(f"Caution: {worst.meaning}{most}.")
    return lines


def stated(result: xr.Dataset, row: int, statistic: str) -> str:
    """Return a statistic of a response with unit and interval; "" where there is none."""
    values = result["estimate"].sel(statistic=statistic).values[row].tolist()
    if np.isnan(values[0]):
        return ""
    if statistic == "exceedance":
        texts = [[f"{number:.{digits}g}" for number in values] for digits in (2, 3, 4)]
        value, low, high = next((text for text in texts if len({*text}) == 3), texts[-1])
        return f"probability {value} ({low} to {high})"
    units = str(result["response_units"].values[row])
    return interval_text(values, units)
