"""Sentences on changes between studies: shares of parameters, or responses of grids."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from impactlab.analysis.differences import differences
from impactlab.figures import access, labels, measures
from impactlab.figures.studies import StudyResults, common_display, shared_family, shared_responses
from impactlab.methods.record import Family, Measure
from impactlab.report.answer import MINOR, packed
from impactlab.report.effects import finite, interval
from impactlab.report.page import Entry
from impactlab.report.ranking import share
from impactlab.report.sensitivity import with_margin
from impactlab.types import Floats

LEAST = 0.02
"""Smallest change of a share that an answer names, however certain it is."""
_PART = 0.3
"""Smallest part of the largest change that is named beside it."""
_MOST = 2
"""Most parameters that are named per response."""
_LINES = 4
"""Most lines of an answer, beside the headline."""
_NEGLIGIBLE = 1e-3
"""Smallest numerical error of a share that is given."""
_FEW = 10
"""Most responses all of which a line names."""
_ROUND_OFF = 1e-6
"""Share of the largest magnitude up to which a value is zero, without a relative change."""
_SAME = 1e-3
"""Largest relative change of a response of a grid that counts as none."""


@dataclass(frozen=True)
class Change:
    """The difference of an index between two studies; interval: half-width; numbers of both."""

    parameter: str
    first: int
    second: int
    difference: float
    interval: float
    is_significant: bool


def compared(studies: Sequence[StudyResults], family: Family) -> dict[str, xr.Dataset]:
    """Return the differences of each response's indices, over the studies that have usable ones.

    `first` and `second` number all of the studies.
    """
    names = [measure.name for measure in common_measures(studies, family)]
    found = {}
    for response in shared_responses(studies):
        usable = [n for n, study in enumerate(studies) if study.is_usable(response)]
        if len(usable) > 1:
            pairs = [(studies[n].runs, studies[n].analysis) for n in usable]
            dataset = differences(pairs, response, names)
            numbers = {key: ("pair", [usable[n] for n in dataset[key].values]) for key in _ENDS}
            found[response] = dataset.assign_coords(numbers)
    return found


_ENDS = ("first", "second")


def common_measures(studies: Sequence[StudyResults], family: Family) -> list[Measure]:
    """Return the measures of a family that all analyses have."""
    shown = family.measures_in(studies[0].analysis)
    return [m for m in shown if all(m.name in study.analysis for study in studies)]


def largest(dataset: xr.Dataset, measure: str) -> list[Change]:
    """Return a change per parameter: from the first to the last study, or else the largest.

    Another pair counts where that of first and last has no significant change of the parameter.
    """
    rows = dataset.sel(measure=measure)
    ends = (rows["first"] == rows["first"].min()) & (rows["second"] == rows["second"].max())
    changes = []
    for parameter in rows["parameter"].values.tolist():
        row = rows.sel(parameter=parameter)
        clear, size = row["is_significant"].values, np.abs(row["difference"].values)
        order = np.lexsort((-size, ~ends.values, ~clear))
        best = row.isel(pair=int(order[0]))
        change = Change(
            parameter,
            int(best["first"]),
            int(best["second"]),
            float(best["difference"]),
            float(best["difference_interval"]),
            bool(best["is_significant"]),
        )
        changes.append(change)
    return changes


def named(changes: Sequence[Change], family: Family) -> list[Change]:
    """Return the significant changes that an answer names, the largest first."""
    clear = sorted((c for c in changes if c.is_significant), key=lambda c: -abs(c.difference))
    least = LEAST if family.shares else 0.0
    top = abs(clear[0].difference) if clear else 0.0
    return [c for c in clear if abs(c.difference) >= max(least, _PART * top)][:_MOST]


def ends(first: str, last: str) -> str:
    """Return two labels as a span: "1 to 15 m/s", a shared unit once; titles in quotation marks."""
    number, _, unit = first.partition(" ")
    if unit and last.endswith(f" {unit}") and number[:1].isdigit():
        return f"{number} to {last}"
    are_titles = any(" " in text and not text[:1].isdigit() for text in (first, last))
    return " to ".join(f"“{text}”" if are_titles else text for text in (first, last))


def index_text(study: StudyResults, family: Family, response: str, parameter: str) -> str:
    """Return the index of a parameter in one study with its interval: "36 ± 3 %"."""
    measure = family.ranked_by(study.analysis).name
    return written(study, family, measure, response, parameter)


def written(
    study: StudyResults, family: Family, measure: str, response: str, parameter: str
) -> str:
    """Return one measure of a parameter with its interval, and a numerical error above that."""
    index = measures.index(study.analysis, measure, response)
    number = measures.parameters(study.analysis).index(parameter)
    value, margin = float(index.values[number]), float(index.margins[number])
    if family is measures.SOBOL:
        error = float(index.numerical[number])
        return share(value, margin, error if error >= _NEGLIGIBLE else 0.0)
    if family.shares:
        return with_margin(value, margin)
    unit = labels.display(study.runs[response].isel(run=[0]).copy(data=[value]))
    return f"{with_margin(float(unit(value)), float(unit(margin)))} {unit.symbol}".strip()


def difference_text(
    studies: Sequence[StudyResults], family: Family, response: str, change: Change
) -> tuple[str, str]:
    """Return a difference with its interval, or that there is none beyond it; and its studies."""
    if not np.isfinite(change.difference + change.interval):
        return "unknown", ""
    span = ends(studies[change.first].label, studies[change.second].label)
    if not change.is_significant:
        return "none beyond its error", span
    sign = "+" if change.difference > 0 else ""
    if family is measures.SOBOL:
        return f"{sign}{share(change.difference, change.interval, 0.0)}".replace("-", "−"), span
    if family.shares:
        return f"{sign}{with_margin(change.difference, change.interval)}", span
    unit = common_display(studies, response)
    values = (float(unit(value)) for value in (change.difference, change.interval))
    return f"{sign}{with_margin(*values)} {unit.symbol}".strip(), span


def meaning(studies: Sequence[StudyResults], parameter: str) -> str:
    """Return the meaning of a varied parameter, or the name of a group."""
    for study in studies:
        listed = measures.parameters(study.analysis)
        if parameter in listed:
            return measures.meanings(study.analysis)[listed.index(parameter)]
    return labels.response(parameter)


def index_sentence(
    studies: Sequence[StudyResults], family: Family, response: str, dataset: xr.Dataset
) -> str:
    """Return what changes in the indices of a response between the studies, in a sentence."""
    measure = family.ranked_by(studies[0].analysis)
    found = named(largest(dataset, measure.name), family)
    if not found:
        listed = labels.listing([studies[n].label for n in _numbers(dataset)])
        size = f" by {labels.percent(LEAST)} or more" if family.shares else ""
        return (
            f"No index of the {labels.response(response)} differs{size} beyond its error: {listed}"
        )
    texts = [_moved(studies, family, response, change) for change in found]
    one = found[0]
    span = ends(studies[one.first].label, studies[one.second].label)
    names = [meaning(studies, change.parameter) for change in found]
    names = [f"the {name}" if " " in name else name for name in names]
    subject = f"the share of {names[0]} in the scatter of the {labels.response(response)}"
    if family is not measures.SOBOL:
        subject = f"the index of {names[0]} for the {labels.response(response)} ({measure.label})"
    text = f"From {span} {subject}"
    moves = [f"that of {name} {moved}" for name, moved in zip(names, texts, strict=True)][1:]
    return ", ".join([f"{text} {texts[0]}", *moves])


def _moved(studies: Sequence[StudyResults], family: Family, response: str, change: Change) -> str:
    verb = "rises" if change.difference > 0 else "falls"
    before, after = (
        index_text(studies[n], family, response, change.parameter)
        for n in (change.first, change.second)
    )
    return f"{verb} from {before} to {after}"


def _numbers(dataset: xr.Dataset) -> list[int]:
    return sorted({*dataset["first"].values.tolist(), *dataset["second"].values.tolist()})


def index_entries(
    studies: Sequence[StudyResults], family: Family, found: dict[str, xr.Dataset], lead: str
) -> list[Entry]:
    """Return one entry per response with a change, and one on the others."""
    entries, none = [], []
    measure = family.ranked_by(studies[0].analysis).name
    for response, dataset in found.items():
        changes = named(largest(dataset, measure), family)
        if response == lead:
            continue
        texts = [
            f"{meaning(studies, change.parameter)} {_moved(studies, family, response, change)}"
            for change in changes
        ]
        if texts:
            between = {_between(studies, change) for change in changes} - {""}
            entries.append((labels.title(response), ", ".join([*texts, *between])))
        else:
            none.append(labels.response(response))
    return [*entries, ("No clear change", labels.listing(none))] if none else entries


def _between(studies: Sequence[StudyResults], change: Change) -> str:
    """Return the studies of a change, "" where they are the first and the last."""
    if (change.first, change.second) == (0, len(studies) - 1):
        return ""
    return f"from {ends(studies[change.first].label, studies[change.second].label)}"


def unusable(studies: Sequence[StudyResults]) -> list[Entry]:
    """Return the responses that a study has no usable indices of, with the reason."""
    texts = []
    for response in shared_responses(studies):
        doubtful = [study for study in studies if not study.is_usable(response)]
        verdicts = {s.label: access.verdict(s.analysis, access.VERDICT, response) for s in doubtful}
        reasons = [f"{label}: {v.words}" for label, v in verdicts.items() if v]
        if reasons:
            texts.append(f"{labels.response(response)} ({', '.join(reasons)})")
    return [("Without usable indices", ", ".join(texts))] if texts else []


def levels(studies: Sequence[StudyResults], names: Sequence[str]) -> list[Entry]:
    """Return one entry on the means of some responses in the first and in the last study."""
    texts = []
    for name in names:
        unit = common_display(studies, name)
        values = [float(access.usable(s.runs, name).mean()) for s in (studies[0], studies[-1])]
        numbers = [labels.number(float(unit(value)), 3) for value in values]
        text = f"{labels.response(name)} {numbers[0]} to {numbers[1]} {unit.symbol}"
        texts.append(text.strip())
    return [(f"Means from {ends(studies[0].label, studies[-1].label)}", ", ".join(texts))]


def response_sentence(studies: Sequence[StudyResults], response: str) -> str:
    """Return how a response of grids changes from the first to the last study, in a sentence."""
    span = ends(studies[0].label, studies[-1].label)
    head, unit = f"From {span} the {labels.response(response)}", common_display(studies, response)
    ratio, *both = _ratio(studies, response)
    if not ratio.notnull().any():
        spans = [labels.span(unit(_known(values)), 3) for values in both]
        return f"{head} goes from {spans[0]} to {spans[1]} {unit.symbol}".rstrip()
    low, high = float(ratio.min()), float(ratio.max())
    place = {str(dim): int(number) for dim, number in abs(ratio).argmax(...).items()}
    before, after = (labels.number(float(unit(part.isel(place))), 3) for part in both)
    values = f"from {before} to {after} {unit.symbol}".rstrip()
    where = [labels.brief(ratio[dim], number) for dim, number in place.items()]
    if where:
        values += f" at {', '.join(where)}"
    if max(-low, high) <= _SAME:
        return f"{head} changes by less than {labels.percent(_SAME)}"
    if low < -_SAME and high > _SAME:
        return f"{head} changes by {interval(low, high)}, most {values}"
    verb, size = ("rises", high) if high > _SAME else ("falls", -low)
    return f"{head} {verb} by {'up to ' if where else ''}{labels.percent(size)}, {values}"


def response_entries(studies: Sequence[StudyResults], names: Sequence[str]) -> list[Entry]:
    """Return entries on the relative changes of responses of grids, and on those that stay."""
    changed, same = [], []
    for name in names:
        ratio = _ratio(studies, name)[0]
        if not ratio.notnull().any():
            continue
        low, high = float(ratio.min()), float(ratio.max())
        response = labels.response(name)
        if max(-low, high) <= _SAME:
            same.append(response)
        else:
            changed.append(f"{response} {interval(low, high)}")
    entries = [("Changes of other responses", ", ".join(changed))] if changed else []
    none = f"Change by less than {labels.percent(_SAME)}"
    return [*entries, (none, labels.listing(same))] if same else entries


def _ratio(
    studies: Sequence[StudyResults], response: str
) -> tuple[xr.DataArray, xr.DataArray, xr.DataArray]:
    """Return relative changes from the first to the last study, and both, where they have points.

    Without common points there are no changes, and both have all of theirs.
    """
    both = [finite(study.runs, response) for study in (studies[0], studies[-1])]
    both = [v.drop_vars([name for name in v.coords if name not in v.dims]) for v in both]
    first, last = xr.align(*both, join="inner")
    least = _ROUND_OFF * float(max(abs(values).max() for values in both))
    change = (last - first) / abs(first).where(abs(first) > least)
    if change.notnull().any():
        return change, first, last
    return change, both[0], both[1]


def _known(values: xr.DataArray) -> Floats:
    return np.asarray(values.values[np.isfinite(values.values)])


@dataclass(frozen=True)
class Findings:
    """The answer of a comparison, and the differences that it rests on.

    lead: the response of the headline. lines: entries of each further line. by_response: the
    differences of indices, see `compared`.
    """

    lead: str
    headline: str
    lines: list[list[Entry]]
    by_response: dict[str, xr.Dataset]

    @property
    def sentences(self) -> list[str]:
        """The answer as sentences, the headline first."""
        texts = ["; ".join(": ".join(entry) for entry in line) for line in self.lines]
        return [f"{text}." for text in (self.headline, *texts)]


def findings(studies: Sequence[StudyResults]) -> Findings:
    """Return what changes between the studies."""
    names, family = shared_responses(studies), shared_family(studies)
    if not access.is_sample(studies[0].runs):
        lead = access.leading(studies[0].runs, names)
        minor = (*MINOR, "energy_error") if len(names) > _FEW else ()
        others = [name for name in names if name != lead and name not in minor]
        entries = response_entries(studies, others)
        return Findings(lead, response_sentence(studies, lead), packed(entries, _LINES), {})
    found = compared(studies, family) if family else {}
    last = [[entry] for entry in (*levels(studies, names), *unusable(studies))]
    if family is None or not found:
        lead = access.leading(studies[0].runs, names)
        ((subject, text),) = levels(studies, [lead])
        return Findings(lead, f"{subject}: {text}", last, found)
    lead = access.leading(studies[0].runs, [*found])
    entries = index_entries(studies, family, found, lead)
    headline = index_sentence(studies, family, lead, found[lead])
    return Findings(lead, headline, [*packed(entries, _LINES - len(last)), *last], found)
