"""Data access: the responses, failed runs and verdicts that stored datasets hold."""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import reduce
from operator import or_
from statistics import NormalDist

import numpy as np
import xarray as xr

from impactlab import wings
from impactlab.figures import labels
from impactlab.model.parameters import PARAMETERS
from impactlab.variables import FAILED, RESPONSES, of_function, of_table, reasons, status_bits

SAMPLED = ("time", "field_time", "x", "z", "strike", "sphere")
"""Dimensions within a run; every other dimension of a variable of runs.nc is the design's."""
VERDICT = "sensitivity_verdict"
"""Variable of the verdicts on sensitivity indices."""
UNEXPLAINED = "no reason is recorded"


def names(runs: xr.Dataset, attribute: str) -> list[str]:
    """Return a list attribute; netCDF stores a list of one as a plain string."""
    return [str(name) for name in np.atleast_1d(runs.attrs.get(attribute, []))]


def varied(runs: xr.Dataset) -> list[str]:
    """Return the names of the varied parameters of the dataset, in the study file's order."""
    return [name for name in names(runs, "varied") if name in runs.coords]


def responses(runs: xr.Dataset) -> list[str]:
    """Return the names of the stored responses, in the order of the table of variables.

    Those that the table does not know come last; those of a function are in the study's order.
    """
    listed = names(runs, "responses")
    if not of_function(runs):
        listed = [*RESPONSES, *(name for name in listed if name not in RESPONSES)]
    return [name for name in listed if name in runs.data_vars]


def leading(runs: xr.Dataset, candidates: Sequence[str]) -> str:
    """Return the response that the study's title names first, or else the first candidate."""
    title = str(runs.attrs.get("title", "")).lower()
    places = {name: title.find(labels.response(name).lower()) for name in candidates}
    named = [name for name in candidates if places[name] >= 0]
    return min(named, key=places.__getitem__, default=candidates[0])


def known(analysis: xr.Dataset, response: str) -> bool:
    """Return whether the analysis has a response."""
    return "response" in analysis.coords and response in analysis["response"].values


def design_dims(runs: xr.Dataset, dims: Iterable[object] | None = None) -> list[str]:
    """Return the dimensions that number the runs (of `dims`, if given), in their order."""
    parameters = names(runs, "varied")  # functions may have a parameter x
    every = runs.dims if dims is None else dims
    return [str(dim) for dim in every if dim not in SAMPLED or dim in parameters]


def is_sample(runs: xr.Dataset) -> bool:
    """Return whether the runs are a random sample (dimension `run`) and not a grid."""
    return "run" in runs.dims


def physical(runs: xr.Dataset) -> list[str]:
    """Return the varied parameters that are numbers and belong to the impact, not the numerics."""
    return [
        name
        for name in varied(runs)
        if runs[name].dtype.kind in "if"
        and (of_function(runs) or PARAMETERS[name].path[0] == "impact")
    ]


def further_models(runs: xr.Dataset) -> list[wings.FurtherModel]:
    """Return the models of wings that some of the runs have."""
    return [] if of_function(runs) else wings.among(runs.coords.get("beam_model", ""))


def count(runs: xr.Dataset) -> int:
    """Return the number of runs of the design."""
    return int(np.prod([runs.sizes[dim] for dim in design_dims(runs)], dtype=int))


def usable(runs: xr.Dataset, name: str) -> xr.DataArray:
    """Return a variable of the runs, NaN where the run's status says that it does not hold."""
    if "status" not in runs:
        return runs[name]
    values, status = runs[name], runs.variables["status"]
    sound = values.variable.where((status & status_bits([name])) == 0)
    if sound.dims != values.dims:
        values = values.broadcast_like(runs["status"]).transpose(*sound.dims)
    # with the coordinates as they are: to merge a hundred of them takes most of a report's time
    masked: xr.DataArray = values.copy(deep=False, data=sound.data)
    return masked


def bare(array: xr.DataArray) -> xr.DataArray:
    """Return an array without coordinates that are no axis: arithmetic compares each of them."""
    return array.reset_coords(drop=True)


def means_by_word(
    runs: xr.Dataset, parameter: str, response: str
) -> dict[str, tuple[float, float]]:
    """Return the mean of a response by word of a parameter, with the half-width of its interval.

    In SI units, NaN for a word without an answer. Of a Sobol sample only base samples count as
    independent draws.
    """
    values, means = usable(runs, response).values, {}
    confidence = float(runs.attrs.get("confidence", 0.95))
    share = float(runs.attrs.get("base_samples", values.size)) / values.size
    for word in np.atleast_1d(runs[parameter].attrs["values"]).tolist():
        answers = values[(runs[parameter].values == word) & np.isfinite(values)]
        half = np.nan
        if (number := share * answers.size) > 1:
            half = NormalDist().inv_cdf((1 + confidence) / 2) * answers.std() / np.sqrt(number)
        means[str(word)] = float(answers.mean()) if answers.size else np.nan, float(half)
    return means


def absent(runs: xr.Dataset, name: str) -> xr.DataArray:
    """Return True for each run (design dimensions) in which a variable has no finite value."""
    array = bare(usable(runs, name))
    present: xr.DataArray = xr.apply_ufunc(np.isfinite, array, dask="allowed")
    return ~present.any([*set(array.dims) - {*design_dims(runs, array.dims)}])


def failed(runs: xr.Dataset) -> xr.DataArray:
    """Return True, on the design dimensions, where a run failed or lacks a response."""
    marks = [absent(runs, name) for name in responses(runs)]
    if "status" in runs:
        marks.append((bare(runs["status"]) & FAILED) != 0)
    return reduce(or_, marks, xr.DataArray(False))


def causes(runs: xr.Dataset, mask: xr.DataArray) -> Counter[str]:
    """Return the number of the marked runs per reason; mask: bool on the design dimensions."""
    status, chosen = xr.broadcast(runs.get("status", xr.zeros_like(mask, dtype=int)), mask)
    bits, counts = np.unique(status.values[chosen.values], return_counts=True)
    unexplained = "the table has no value there" if of_table(runs) else UNEXPLAINED
    tally: Counter[str] = Counter()
    for bit, number in zip(bits.tolist(), counts.tolist(), strict=True):
        tally["; ".join(reasons(int(bit))) or unexplained] += number
    return tally


def missing_note(runs: xr.Dataset, variables: Sequence[str]) -> str:
    """Return a caption's sentence on the runs that lack one of the variables; "" without any."""
    held = [absent(runs, name) for name in variables if name in runs]
    mask = reduce(or_, held, xr.DataArray(False))
    return missing_words(runs, mask, "here" if len(held) == 1 else "in one panel or more")


def missing_words(runs: xr.Dataset, mask: xr.DataArray, where: str) -> str:
    """Return a sentence on the marked runs and the reasons; "" without any."""
    if not bool(mask.any()):
        return ""
    counts = [f"{number} × “{why}”" for why, number in causes(runs, mask).items()]
    total = int(mask.sum())
    verb = "is" if total == 1 else "are"
    return f"{total} of {count(runs)} runs {verb} missing {where}: {labels.listing(counts)}."


@dataclass(frozen=True)
class StatedVerdict:
    """A verdict of the analysis, from its CF flags.

    flag: its name. sound: False where it is a warning. meaning: a sentence or "". value: the
    number that stands for it in the dataset.
    """

    flag: str
    sound: bool
    meaning: str = ""
    value: int = -1

    @property
    def words(self) -> str:
        """The flag's name as text."""
        return self.flag.replace("_", " ")


def verdict(analysis: xr.Dataset, variable: str, response: str) -> StatedVerdict | None:
    """Return a response's verdict; None where the analysis gives none.

    variable: one on `response` alone, with CF flag_values and flag_meanings, and with
    sound_flags and flag_descriptions ("flag: sentence", one line per flag).
    """
    if variable not in analysis or not known(analysis, response):
        return None
    return read(analysis[variable].sel(response=response))


def is_sound(analysis: xr.Dataset, response: str) -> bool:
    """Return whether the indices of a response are usable, as far as the analysis judges them."""
    judgement = verdict(analysis, VERDICT, response)
    return judgement is None or judgement.sound


def read(flag: xr.DataArray) -> StatedVerdict:
    """Return the verdict in a variable of CF flags that holds one value."""
    (single,) = occurring(flag)
    return single


def occurring(flags: xr.DataArray) -> list[StatedVerdict]:
    """Return every flag that occurs in a variable of CF flags, by rising value; none without."""
    if "flag_values" not in flags.attrs:
        return []
    numbers = np.atleast_1d(flags.attrs["flag_values"]).astype(int).tolist()
    names = dict(zip(numbers, str(flags.attrs["flag_meanings"]).split(), strict=True))
    sound = str(flags.attrs.get("sound_flags", "converged usable")).split()
    lines = str(flags.attrs.get("flag_descriptions", "")).splitlines()
    meanings = {name: meaning for name, _, meaning in (line.partition(": ") for line in lines)}
    values = np.unique(flags.values).astype(int).tolist()
    flagged = [(names.get(value, "unknown"), value) for value in values]
    return [
        StatedVerdict(name, name in sound, meanings.get(name, ""), value) for name, value in flagged
    ]


def confidence(analysis: xr.Dataset) -> str:
    """Return the confidence level of the intervals of the indices as text: "95 %"."""
    return f"{100 * float(analysis.attrs.get('confidence', 0.95)):.4g} %"
