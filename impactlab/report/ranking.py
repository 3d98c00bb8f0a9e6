"""The parameters that matter in a sample, in sentences."""

import numpy as np
import xarray as xr

from impactlab.figures import access, labels, measures
from impactlab.figures.measures import MORRIS, SOBOL, Index, analysed
from impactlab.methods.hsic import TARGET
from impactlab.methods.record import Family, SensitivityVerdict
from impactlab.methods.runs import correlations
from impactlab.report.page import Entry
from impactlab.report.sensitivity import decimals_of, in_units, uncertainty, with_margin
from impactlab.variables import of_table
from impactlab.verification.functions import FUNCTIONS

_MATTERS = 0.01
"""Smallest share of the largest index that is named, and largest total order without effect."""
_INTERACTS = 0.02
"""Smallest share of the variance from interactions that is named."""
_LEADING = 0.1
"""Smallest share of the largest index that the headline names."""
_WIDE_ONLY = 1 << (SensitivityVerdict.WIDE_INTERVALS - 1)
"""Remarks on indices that are sound but for their wide intervals."""
_MEASURED = ("rbd_fast",)
"""Indices whose first ranks were measured, see `first_ranks`."""
_MOST = 3
"""Most parameters that are named per response."""


def headline(runs: xr.Dataset, analysis: xr.Dataset, family: Family, response: str) -> str:
    """Return which parameters matter most for a response, in a sentence, and how sure this is."""
    index, name = _index(analysis, family, response), labels.response(response)
    numbers = [n for n in _ranked(index) if _size(index)[n] > _LEADING * _size(index).max()]
    numbers = numbers[:_MOST]
    if not np.isfinite(index.values).any():
        return f"No index of the {name} is defined"
    if not numbers:
        return f"No parameter stands out from the noise in the {name}"
    texts = _texts(runs, analysis, family, response, numbers)
    listed = labels.listing([f"the {text}" if " " in _head(text) else text for text in texts])
    plural = len(numbers) > 1
    if family is not SOBOL:
        text = f"{listed} {'matter' if plural else 'matters'} most for {subject(family, response)}"
    else:
        least = (index.values - index.margins)[numbers].sum()  # where intervals end
        total = least / max(1.0, np.nansum(index.values))
        part = "most" if total > 0.5 else "the largest part"
        text = f"{listed} {'cause' if plural else 'causes'} {part} of the scatter of the {name}"
        if of_table(runs):  # whose rows may be chosen, and correlated
            verb = "explain" if plural else "explains"
            text = f"{listed} {verb} {part} of the variance of the {name} in this table"
    if index.numerically_lost[numbers].any():
        return f"Not usable: the numerical error exceeds an index of the {name} ({listed})"
    if index.numerical.any():
        error, margin = index.numerical[numbers].max(), index.margins[numbers].min()
        size = uncertainty(float(error))
        text += f"; numerical error is {f'negligible ({size})' if error <= margin else size}"
    return labels.sentence(text) if text.startswith("the ") else text


def subject(family: Family, response: str) -> str:
    """Return what the indices of a response are about: the response, or whether it is too large."""
    name = f"the {labels.response(response)}"
    return f"whether {name} exceeds its limit" if family is TARGET.family else name


def _head(text: str) -> str:
    return text.partition(" (")[0]


def entries(
    runs: xr.Dataset, analysis: xr.Dataset, family: Family, responses: list[str]
) -> list[Entry]:
    """Return one entry per response: the parameters that matter, with their indices."""
    listed: list[Entry] = []
    for response in responses:
        index = _index(analysis, family, response)
        none = "no parameter stands out from the noise"
        if not np.isfinite(index.values).any():
            none = "no index is defined"
        numbers = _ranked(index)[:_MOST]
        text = ", ".join(_texts(runs, analysis, family, response, numbers)) or none
        listed.append((labels.title(response), text))
    return listed


def first_ranks(
    runs: xr.Dataset, analysis: xr.Dataset, family: Family, responses: list[str]
) -> dict[str, str]:
    """Return by response of a table the input whose interval lies above all others, though wide.

    tests/benchmarks/first_rank.py measures how often it is not the first one: in none of 200 tables
    of 64, 80 and 160 rows of each of 13 functions.
    """
    texts = {}
    ranking = access.names(runs, "indices")[:1] if of_table(runs) else []
    for response in responses if {*ranking} & {*_MEASURED} else ():
        remarks = int(analysis["sensitivity_remarks"].sel(response=response))
        index = _index(analysis, family, response)
        certain = [number for number, (_, worst) in enumerate(index.ranks) if worst == 1]
        if remarks == _WIDE_ONLY and index.significant[certain].any():
            (text,) = _texts(runs, analysis, family, response, certain)
            texts[response] = f"the {text}" if " " in _head(text) else text
    return texts


def without_effect(analysis: xr.Dataset, family: Family, responses: list[str]) -> list[Entry]:
    """Return the parameters whose total order is below 1 % for all of these responses.

    The whole interval and the numerical error are below it: of 200 samples of Sobol's G function,
    x4 with 1.05 % is called without effect in 2 % at 64 base samples, and in none at 1024.
    """
    if family is not SOBOL or "total_order" not in analysis or not responses:
        return []
    indices = [measures.index(analysis, "total_order", name) for name in responses]
    reach = np.max([index.values + index.margins + index.numerical for index in indices], axis=0)
    meanings = measures.meanings(analysis)
    idle = [meanings[n] for n in np.flatnonzero(reach < _MATTERS)]
    text = f"{labels.listing(idle)} (below {labels.percent(_MATTERS)} each)"
    return [("No effect on any response", text)] if idle else []


def unusable(runs: xr.Dataset, analysis: xr.Dataset) -> list[Entry]:
    """Return the responses whose indices are not usable, with the reason; and gaps in the runs."""
    reasons, missing = [], []
    for name in analysed(runs, analysis):
        verdict, response = access.verdict(analysis, access.VERDICT, name), labels.response(name)
        if verdict and not verdict.sound:
            reasons.append(f"{response} ({verdict.words})")
        if gaps := int(access.absent(runs, name).sum()):
            missing.append(f"{response} ({gaps:,} of {access.count(runs):,})")
    heads = {"Do not rely on the indices of": reasons, "Missing runs": missing}
    return [(head, ", ".join(texts)) for head, texts in heads.items() if texts]


def _index(analysis: xr.Dataset, family: Family, response: str) -> Index:
    return measures.index(analysis, family.ranked_by(analysis).name, response)


def _size(index: Index) -> np.ndarray:
    return np.where(index.above_noise, np.abs(index.values), 0.0)


def _ranked(index: Index) -> list[int]:
    """Return the numbers of the parameters that matter, the largest index first."""
    size = _size(index)
    order = np.argsort(-size, kind="stable").tolist()
    return [number for number in order if size[number] > _MATTERS * size.max()]


def _texts(
    runs: xr.Dataset, analysis: xr.Dataset, family: Family, response: str, numbers: list[int]
) -> list[str]:
    """Return parameters with their indices: "yield stress of the beam (36 ± 3 %)"."""
    names, index = measures.parameters(analysis), _index(analysis, family, response)
    meanings, texts = measures.meanings(analysis), []
    for place, number in enumerate(numbers):
        text = _written(runs, analysis, family, index, response, number)
        means = "" if place else _of_words(runs, names[number], response)
        texts.append(f"{meanings[number]} ({text}{means})")
    if texts and family.explained in analysis:
        fit = float(analysis[family.explained].sel(response=response))
        texts[-1] += f"; R² of the fit {labels.number(fit, 2)}"
    return texts


def _written(
    runs: xr.Dataset,
    analysis: xr.Dataset,
    family: Family,
    index: Index,
    response: str,
    number: int,
) -> str:
    """Return an index with its interval, and of a Sobol index what the parameter does alone."""
    value, margin = float(index.values[number]), float(index.margins[number])
    error = float(index.numerical[number])
    if family is MORRIS:
        return in_units(runs[response], value, margin)
    if family is not SOBOL:
        return with_margin(value, margin)
    text = share(value, margin, error)
    first = measures.index(analysis, "first_order", response)
    surplus = value - first.values[number]  # none where the first order ranks
    reach = margin + first.margins[number] + error + first.numerical[number]
    if surplus > max(_INTERACTS, reach):
        alone = f"{100 * first.values[number]:.0f} % alone"
        text += f", {alone if first.above_noise[number] else 'through interactions'}"
    if "total_order" in analysis and (exact := _exact(runs)):
        text += f", exactly {labels.percent(exact[measures.parameters(analysis)[number]], 3)}"
    return text


def share(value: float, margin: float, error: float) -> str:
    """Return a share of the variance, its half-width and a numerical error that is larger."""
    decimals, within = decimals_of(value, margin), max(100 * margin, 0.1)
    text = f"{100 * value:.{decimals}f} ± {within:.{decimals}f} %"
    return f"{text}, numerically {uncertainty(error)}" if error > margin else text


def _exact(runs: xr.Dataset) -> dict[str, float]:
    """Return the total orders of a function where they are known; {} where they are not."""
    function = FUNCTIONS.get(str(runs.attrs.get("function", "")))
    if function is None or correlations(runs):
        return {}
    for name, ends in function.ranges.items():
        stated = runs[name].attrs if name in access.varied(runs) else {}
        drawn = stated.get("low", np.nan), stated.get("high", np.nan)
        if stated.get("distribution") != "uniform" or not np.allclose(drawn, ends, rtol=1e-3):
            return {}
    return dict(zip(function.ranges, function.total_order.tolist(), strict=True))


def _of_words(runs: xr.Dataset, parameter: str, response: str) -> str:
    """Return which words give the least and the largest mean response; "" for numbers."""
    listed = labels.words(runs[parameter]) if parameter in runs.coords else []
    if not listed:
        return ""
    means = access.means_by_word(runs, parameter, response).values()
    intervals = [
        (interval, word)
        for word, interval in zip(listed, means, strict=True)
        if interval[0] == interval[0]
    ]
    low, high = (
        f"{in_units(runs[response], *interval)} with {word}"
        for interval, word in (min(intervals), max(intervals))
    )
    return f"; on average {low} to {high}"
