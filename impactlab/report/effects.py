"""Effects of a grid's parameters on its responses, in sentences: direction, size, jump, or none."""

from collections import defaultdict
from collections.abc import Iterator
from itertools import product

import numpy as np
import xarray as xr

from impactlab.analysis.regimes import jumps
from impactlab.figures import access, labels
from impactlab.figures.access import design_dims, physical, usable
from impactlab.figures.labels import display
from impactlab.report.cautions import beside
from impactlab.report.page import Entry

_NONE = 1e-3
"""Largest change, relative to the magnitude where it is, that counts as no effect."""
_ROUND_OFF = 1e-6
"""Largest share of the largest magnitude that is taken for zero."""
_SLIGHT = 1e-4
"""Largest share of a range below zero that is left out of it."""
_AGAINST = 0.05
"""Largest movement against a trend, in ranges of the curve."""
_LEVEL = 0.05
"""Largest change over the last third of a curve that levels off, in ranges of the curve."""
_CLEAR = 0.2
"""Smallest change of the mean curve that is a trend, in ranges of all values."""
_FEWEST = 5
"""Fewest values along which a curve is said to turn."""
_SHOWN = 3
"""Most curves that are described one by one."""
_FACTOR = 10.0
"""Largest relative change that is given in per cent."""
_CONTRASTS = 2
"""Most responses whose change with a further parameter is given."""
_NAMED = 6
"""Most responses that one line names."""
_TRENDS = {"rises": "Rise", "falls": "Fall", "jumps": "Jump"}
_UNCLEAR = "varies"


def headline(runs: xr.Dataset, response: str) -> str:
    """Return what the parameters of a grid do to one response, in a sentence."""
    values, name = finite(runs, response), labels.response(response)
    if not np.isfinite(values).any():
        return f"The {name} is missing in every run"
    factors = _factors(values)
    if not factors:
        return f"The {name} is the same in every run, {_range(runs, values)}"
    main = _main(runs, values, factors)
    if main not in physical(runs):
        return f"The {name} is {_by_word(runs, values, main)}"
    others = [dim for dim in factors if dim != main]
    curves = list(_curves(values, main, others))
    over = f"From {_ends(runs[main])} of {labels.parameter(runs[main])} the {name}"
    courses = [_course(runs[response], curve) for _, curve in curves]
    if len(curves) <= _SHOWN:
        places = [_place(runs, where) for where, _ in curves]
        texts = [f"{courses[0][1]} {places[0]}".rstrip()]
        for (_, text), place in list(zip(courses, places, strict=True))[1:]:
            texts.append(f"{place} it {text}")
        return f"{over} {'; '.join(texts)}"
    span, trends = _range(runs, values), {trend for trend, _ in courses}
    ordered = values.sortby(main)
    mean = ordered.where(ordered.notnull().all(main)).mean({*values.dims} - {main})
    size, spread = float(np.ptp(mean.values)), float(values.max() - values.min())
    average = _trend(mean.values, size)
    if average and size > _CLEAR * spread:
        low, high = (_range(runs, ordered.isel({main: end}), "–") for end in (0, -1))
        where = "in every case" if trends == {average} else "on average"
        return f"{over} {average} {where}, from {low} to {high}"
    listed = labels.listing([labels.parameter(runs[dim]) for dim in [main, *others]])
    return f"The {name}, {span}, depends on {listed} together: none of them alone sets its trend"


def spread(runs: xr.Dataset, response: str) -> str:
    """Return the range of one response of a sample, in a sentence."""
    values, name = finite(runs, response), labels.response(response)
    if not np.isfinite(values).any():
        return f"The {name} is missing in every run"
    return f"The {name} takes values from {_range(runs, values)}"


def entries(runs: xr.Dataset, analysis: xr.Dataset, lead: str, shown: list[str]) -> list[Entry]:
    """Return what the headline leaves out: other responses, other parameters, and doubts.

    lead: the response of the headline. shown: all responses that the answer covers.
    """
    factors = _factors(finite(runs, lead)) if np.isfinite(finite(runs, lead)).any() else []
    main = _main(runs, finite(runs, lead), factors) if factors else ""
    others = [name for name in shown if name != lead]
    lines = _trends(runs, others, main) if main in physical(runs) else ranges(runs, others)
    dims = [dim for dim in design_dims(runs) if runs.sizes[dim] > 1 and dim != main]
    lines += [_factor(runs, dim, lead, shown) for dim in dims]
    doubts = []
    for name in shown:
        gaps = int(access.absent(runs, name).sum())
        reasons = [f"missing in {labels.counted(gaps, 'run')}" if gaps else ""]
        reasons.append(beside(runs, analysis, name))
        if any(reasons):
            doubts.append(f"{labels.response(name)} ({'; '.join(filter(None, reasons))})")
    return [*lines, ("Doubtful", ", ".join(doubts))] if doubts else lines


def finite(runs: xr.Dataset, name: str) -> xr.DataArray:
    """Return a response without infinite values, and with zero for round-off."""
    values = usable(runs, name)
    finite = values.where(np.isfinite(values))
    return finite.where(~(abs(finite) < _ROUND_OFF * abs(finite).max()), 0.0)


def _change(values: xr.DataArray, dim: str) -> float:
    """Return the largest change along a parameter, relative to the magnitude where it is."""
    change, magnitude = values.max(dim) - values.min(dim), abs(values).max(dim)
    return float((change / magnitude.where(magnitude > 0)).fillna(0.0).max())


def _factors(values: xr.DataArray) -> list[str]:
    """Return the parameters that change a response, in their order."""
    return [
        str(dim)
        for dim in values.dims
        if values.sizes[dim] > 1 and _change(values, str(dim)) > _NONE
    ]


def _main(runs: xr.Dataset, values: xr.DataArray, factors: list[str]) -> str:
    """Return the parameter, a number where there is one, whose mean effect varies most."""
    numbers = [dim for dim in factors if dim in physical(runs)]
    effects = {dim: float(values.mean({*values.dims} - {dim}).var()) for dim in numbers or factors}
    return max(effects, key=effects.__getitem__)


def _curves(
    values: xr.DataArray, main: str, others: list[str]
) -> Iterator[tuple[dict[str, int], xr.DataArray]]:
    """Yield each curve along a parameter, and the positions of the others that matter."""
    rest = {str(dim): 0 for dim in values.dims if dim not in (main, *others)}
    ordered = values.isel(rest).sortby(main)
    for positions in product(*(range(values.sizes[dim]) for dim in others)):
        where = dict(zip(others, positions, strict=True))
        yield where, ordered.isel(where)


def _place(runs: xr.Dataset, where: dict[str, int]) -> str:
    """Return the values of other parameters in words: "with Hertz", "at 20 mm of depth"."""
    texts = []
    for dim, position in where.items():
        value = labels.values(runs[dim], [position], short=True)[0]
        is_number = runs[dim].dtype.kind in "if"
        value += f"{labels.unit(runs[dim])} of {labels.parameter(runs[dim])}" if is_number else ""
        texts.append(f"{'at' if is_number else 'with'} {value}")
    return " and ".join(texts)


def _course(response: xr.DataArray, curve: xr.DataArray) -> tuple[str, str]:
    """Return the trend of a curve along its one dimension, and its description."""
    curve = curve[np.isfinite(curve.values)]
    (dim,) = curve.dims
    places, values = curve[dim], curve.values
    unit = labels.unit(response)
    texts = [labels.number(float(value), 3) for value in display(response)(values)]
    if values.size < 2 or np.ptp(values) <= _NONE * np.abs(values).max():
        return "stays", f"stays at {texts[0]}{unit}" if texts else "is missing"
    sizes = np.abs(np.diff(values))
    if (steps := jumps(places.values.astype(float), values)).size:
        step = int(steps[np.argmax(sizes[steps])])
        between = labels.listing(labels.values(places, [step, step + 1])) + labels.unit(places)
        before = _course(response, curve[: step + 1])[1] + ", then" if step > 0 else ""
        start = "" if step > 0 else f" from {texts[0]}"
        jump = f"jumps{start} to {texts[step + 1]}{unit} between {between}"
        return "jumps", f"{before} {jump}".strip()
    if trend := _trend(values, np.ptp(values)):
        last = values[-max(3, values.size // 3) :]
        level = values.size > 2 * last.size - 1 and np.ptp(last) <= _LEVEL * np.ptp(values)
        ending = f"{unit} and levels off at" if level else " to"
        return trend, f"{trend} from {texts[0]}{ending} {texts[-1]}{unit}"
    for turn in (int(values.argmax()), int(values.argmin())) if values.size >= _FEWEST else ():
        parts = values[: turn + 1], values[turn:]
        trends = [_trend(part, np.ptp(values)) if part.size > 1 else "" for part in parts]
        if all(trends):
            peak = labels.value(places, turn)
            text = f"{trends[0]} from {texts[0]} to {texts[turn]}{unit} at {peak}"
            return _UNCLEAR, f"{text}, then {trends[1]} to {texts[-1]}{unit}"
    low, high = texts[int(values.argmin())], texts[int(values.argmax())]
    return _UNCLEAR, f"varies between {low} and {high}{unit} without a clear trend"


def _trend(values: np.ndarray, size: float) -> str:
    """Return the direction of some values of a curve of this range; "" without one."""
    steps = np.diff(values)
    net = values[-1] - values[0]
    against = np.abs(steps[np.sign(steps) == -np.sign(net)]).sum()
    if net == 0 or against > _AGAINST * size:
        return ""
    return "rises" if net > 0 else "falls"


def _ends(coordinate: xr.DataArray) -> str:
    return labels.span(display(coordinate)(coordinate.values), 4) + labels.unit(coordinate)


def _range(runs: xr.Dataset, values: xr.DataArray, dash: str = " to ") -> str:
    response = runs[values.name]
    numbers = display(response)(values.values[np.isfinite(values.values)])
    if not numbers.size:
        return "no value"
    if 0.0 < -numbers.min() < _SLIGHT * numbers.max():
        numbers = numbers.clip(min=0.0)
    return labels.span(numbers, 3).replace(" to ", dash) + labels.unit(response)


def _trends(runs: xr.Dataset, names: list[str], main: str) -> list[Entry]:
    """Return one entry per trend along a parameter: the responses that have it, with ranges."""
    groups: dict[str, list[str]] = defaultdict(list)
    for name in names:
        values = finite(runs, name)
        trends = set()
        if main in values.dims and np.isfinite(values).any():
            others = [str(dim) for dim in values.dims if dim != main]
            trends = {_course(runs[name], curve)[0] for _, curve in _curves(values, main, others)}
        trends -= {"stays"} if trends - {"stays"} else set()
        trend = trends.pop() if len(trends) == 1 else ("jumps" if "jumps" in trends else _UNCLEAR)
        groups[trend].append(f"{labels.response(name)} ({_range(runs, values)})")
    subject = f"with {labels.parameter(runs[main])}"
    heads = {trend: f"{word} {subject}" for trend, word in _TRENDS.items()}
    heads |= {_UNCLEAR: f"No single direction {subject}", "stays": f"Do not change {subject}"}
    return [(heads[trend], _listed(groups[trend])) for trend in heads if trend in groups]


def ranges(runs: xr.Dataset, names: list[str]) -> list[Entry]:
    """Return one entry on the ranges of responses."""
    texts = [f"{labels.response(name)} {_range(runs, finite(runs, name))}" for name in names]
    return [("Ranges", _listed(texts))] if texts else []


def _listed(items: list[str]) -> str:
    beyond = len(items) - _NAMED
    more = f" and {labels.counted(beyond, 'other')}" if beyond > 0 else ""
    return ", ".join(items[:_NAMED]) + more


def _factor(runs: xr.Dataset, dim: str, lead: str, shown: list[str]) -> Entry:
    """Return what a parameter beside the headline's does: to its response, or else to any."""
    changes = {
        name: _change(values, dim)
        for name in shown
        if dim in (values := finite(runs, name)).dims and np.isfinite(values).any()
    }
    none = f"below {labels.percent(_NONE)}"
    names = [name for name in changes if changes[name] > _NONE]
    names.sort(key=lambda name: (name != lead, -changes[name]))
    if not names:
        subject = labels.sentence(labels.parameter(runs[dim]))
        return subject, f"no effect on any response ({none})"
    texts = [f"{labels.response(name)} {_contrast(runs, name, dim)}" for name in names[:_CONTRASTS]]
    if names[0] != lead:
        texts.insert(0, f"no effect on the {labels.response(lead)} ({none})")
    return _comparison(runs, dim), ", ".join(texts)


def _comparison(runs: xr.Dataset, dim: str) -> str:
    """Return a parameter and its first and last value: "Depth of the beam, 8 to 80 mm"."""
    values, subject = runs[dim], labels.sentence(labels.parameter(runs[dim]))
    if values.dtype.kind in "if":
        return f"{subject}, {_ends(values)}"
    if values.size > 2:
        return subject
    low, high = labels.values(values, [0, 1], short=True)
    return f"{subject}, {high} instead of {low}"


def _contrast(runs: xr.Dataset, name: str, dim: str) -> str:
    """Return the change of the response from the first to the last value."""
    values, is_number = finite(runs, name), runs[dim].dtype.kind in "if"
    if not is_number and values.sizes[dim] > 2:
        return _by_word(runs, values, dim)
    ordered = values.sortby(dim) if is_number else values
    first, last = ordered.isel({dim: 0}), ordered.isel({dim: -1})
    ratio = ((last - first) / abs(first)).values
    ratio = np.sort(ratio[np.isfinite(ratio)])
    if not ratio.size or np.abs(ratio).max() > _FACTOR or bool((first == 0).any()):
        before, after = _range(runs, first, "–"), _range(runs, last, "–")
        return f"{after} instead of {before}"
    return interval(*ratio[[0, -1]].tolist())


def interval(low: float, high: float) -> str:
    """Return two relative changes in per cent: "−2.4 to +12 %"."""
    texts = [f"{'+' if end > 0 else ''}{labels.number(100 * end, 2)}" for end in (low, high)]
    return f"{' to '.join(dict.fromkeys(texts))} %"


def _by_word(runs: xr.Dataset, values: xr.DataArray, dim: str) -> str:
    """Return which words of a parameter have the least and the largest mean of a response."""
    means = values.mean({*values.dims} - {dim}, keep_attrs=True).rename(values.name)
    order = np.argsort(means.values)[: int(np.isfinite(means).sum())]
    low, high = (
        f"with {labels.values(runs[dim], [end], short=True)[0]} ({_range(runs, means[[end]])})"
        for end in (order[0], order[-1])
    )
    average = " on average" if means.size < values.size else ""
    return f"least{average} {low}, largest {high}"
