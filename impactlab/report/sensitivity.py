"""Sections on sensitivity, in the order of sensobol (Puy et al. 2022, J. Stat. Softw. 102).

One parameter ranks before another only where their intervals, with the numerical error, do not
overlap.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from itertools import combinations

import numpy as np
import xarray as xr

from impactlab.analysis.sensitivity.over_time import TimeVerdict
from impactlab.figures import access, labels, measures
from impactlab.figures.labels import display
from impactlab.figures.measures import MORRIS, SOBOL, SURROGATE, analysed
from impactlab.methods import indices_of, verdict_name
from impactlab.methods.record import Family, Measure
from impactlab.methods.runs import correlations
from impactlab.report.page import Cell, Row, Section, Table, largest

_COARSE = 0.02  # smallest half-width of shares given in whole per cent
_SMALL = 0.1  # smallest share given in whole per cent
_GOOD = 0.9  # least lower end of the predictivity of a surrogate that may replace the runs
_FINE = 0.005  # half-width below which a third decimal means something
_LEAST = 0.001  # magnitude below which an index and its half-width are not printed separately
_NAMED = 3  # most parameters that are named for a history
_TINY = 0.001  # share below which an uncertainty is only bounded
_LEAD = (
    "The runs have a numerical error, which was estimated by refining the discretisation. An index "
    "that this error could change by as much as its own value is not distinguishable from it, "
    "however narrow the interval, and no sentence calls it significant."
)
_BASES = {
    "measured": (
        " The error of the indices was measured where the first runs of the sample were solved "
        "again on finer grids; a change that is common to all runs changes no index."
    ),
    "bound": (
        " Where it is only a bound, it follows from the errors of corner cases and is usually far "
        "too large; impactlab refine measures it for a Sobol sample whose runs do not fail."
    ),
}
"""What the numerical error rests on, by the flags of `numerical_from`."""
_OF_RESPONSES = {
    "numerical_uncertainty": "Numerical uncertainty",
    "numerical_share": "Share of the variance that could be numerical",
}


def sections(runs: xr.Dataset, analysis: xr.Dataset) -> Iterator[Section]:
    """Yield the sections, from the ranking to the surrogate, that the analysis has data for."""
    if not analysed(runs, analysis):
        return
    if families := measures.families(runs, analysis):
        lead = (
            "A rank is a range where intervals overlap; they are widened by the numerical error "
            f"where it is known. {shared(runs)}"
        ).rstrip()
        ranks = [_ranks(runs, analysis, families[0])]
        yield Section("ranking", "Ranking", lead, tables=ranks, file="indices.csv")
    yield from _of_sobol(runs, analysis)
    for family in families:
        if family is not SOBOL:
            yield Section(
                family.figure.partition("_")[0],
                family.title,
                family.meaning,
                figures=[family.figure],
                folded=index_tables(runs, analysis, family),
            )
    if "surrogate_q2" in analysis:
        yield surrogate(runs, analysis)
    elif correlations(runs):
        lead = "There is none, nor an explorer: its terms assume independent parameters."
        yield Section("surrogate", "Surrogate", lead)
    elif categorical := [name for name in access.varied(runs) if labels.words(runs[name])]:
        listed = labels.listing([labels.parameter(runs[name]) for name in categorical])
        lead = f"There is none, nor an explorer: no polynomial follows words ({listed})."
        yield Section("surrogate", "Surrogate", lead)


def shared(runs: xr.Dataset) -> str:
    """Return a sentence on what correlations mean for the indices; "" where there are none."""
    if not (pairs := correlations(runs)):
        return ""
    joined = dict.fromkeys(name for first, second, _ in pairs for name in (first, second))
    meaning = indices_of(runs.attrs)[0].family.if_correlated
    listed = labels.listing([labels.parameter(runs[name]) for name in joined])
    return f"The inputs are correlated ({listed}): {meaning}."


def _of_sobol(runs: xr.Dataset, analysis: xr.Dataset) -> Iterator[Section]:
    if SOBOL.given(analysis):
        total = "total_order" in analysis
        yield Section(
            "sensitivity",
            "First and total order" if total else "First order",
            "A first-order index is the share of the variance that comes from a parameter alone"
            f"{'; a total-order index adds all its interactions' if total else ''}"
            ". Indices in grey are not distinguishable from zero.",
            tables=index_tables(runs, analysis, SOBOL),
            figures=[SOBOL.figure],
        )
    if "second_order" in analysis:
        yield Section(
            "second-order",
            "Second order",
            "A second-order index is the share of the variance that comes from two parameters "
            "together, beyond what each contributes alone.",
            figures=["sobol_second_order"],
            folded=[second_order(runs, analysis)],
        )
    by_samples = [order.name for order in SOBOL.measures if f"{order.name}_by_samples" in analysis]
    if by_samples:
        yield Section(
            "index-convergence",
            "Convergence of the indices",
            "The figures show the indices from the first part of the sample alone; no run was "
            "solved again. An index that still drifts at the right end is not known better than "
            "its drift.",
            figures=[f"{name}_convergence" for name in by_samples],
        )
    if histories := measures.histories(analysis):
        yield Section(
            "over-time",
            "Indices over time",
            "A history has indices at each time, and generalised indices: shares of its variance "
            "added up over all times, so that times at which the runs differ most count most. A "
            "base sample is left out where one of its runs failed; there is no index at a time at "
            "which all runs have one value.",
            tables=[_generalised(analysis, histories, measure) for measure in SOBOL.measures],
            figures=["indices_over_time"],
        )


def history_entries(analysis: xr.Dataset) -> list[tuple[str, str]]:
    """Return one entry per history: the parameters that matter over all times, or why none."""
    entries: list[tuple[str, str]] = []
    key = "generalised_total_order"
    for history in measures.histories(analysis):
        indices, names = analysis.sel(history=history), measures.meanings(analysis)
        total, margin = (indices[name].values for name in (key, f"{key}_interval"))
        ranked = [i for i in np.argsort(-total, kind="stable") if total[i] > margin[i]][:_NAMED]
        shares = [f"{names[i]} {_share(total[i], margin[i])}" for i in ranked]
        text = labels.listing(shares) or "no parameter exceeds its interval"
        if shares and not entries:
            text += " of the variance"
        texts = [text] if np.isfinite(total).any() else []
        verdict = access.read(indices[measures.HISTORY_VERDICT])
        if not verdict.sound:
            texts.append(verdict.meaning)
        entries.append((f"{labels.title(history)} over time", "; ".join(texts)))
    return entries


def _generalised(analysis: xr.Dataset, histories: list[str], measure: Measure) -> Table:
    """Return one row per history: its generalised indices, grey within noise, and the gaps."""
    rows: list[Row] = []
    for history in histories:
        indices, key = analysis.sel(history=history), f"generalised_{measure.name}"
        name = _judged(history, access.read(indices[measures.HISTORY_VERDICT]))
        cells = [_index(indices.sel(parameter=p), key) for p in analysis["parameter"]]
        constant = int((indices["time_verdict"] == TimeVerdict.CONSTANT).sum())
        gaps = (
            f"{int(indices['base_samples_left_out'])} of {int(analysis.attrs['base_samples'])}",
            f"{constant} of {indices.sizes['time']}",
        )
        rows.append([name, *cells, *(Cell(text, "number") for text in gaps)])
    caption = _caption(f"Generalised Sobol indices, {measure.label}", analysis)
    head = ["History", *_parameters(analysis), "Base samples left out", "Times without an index"]
    meanings = _meanings(analysis, measures.HISTORY_VERDICT)
    return Table(caption, head, rows, meanings=meanings)


def surrogate(runs: xr.Dataset, analysis: xr.Dataset) -> Section:
    """Return the section on the surrogate: its error on runs left out, and its indices."""
    rows: list[Row] = []
    for name in analysed(runs, analysis):
        statistics = analysis.sel(response=name)
        q2 = float(statistics["surrogate_q2"])
        quality = Cell("undefined", "muted")
        if np.isfinite(q2):
            low = float(statistics["surrogate_q2_low"])
            kind, detail = ("number", "at least") if low >= _GOOD else ("warning", "poor: at least")
            quality = Cell(labels.number(q2, 3), kind, f"{detail} {labels.number(low, 3)}")
        error = in_units(runs[name], float(statistics["surrogate_rmse"]))
        rows.append([named(analysis, name), quality, Cell(error, "number")])
    caption = (
        "The surrogate on runs left out (1: perfect, 0: no better than the mean), with the lower "
        "end of the 95 % interval"
    )
    head = ["Response", "Predictivity Q² on runs left out", "Root mean square error"]
    fitted = SURROGATE.given(analysis)
    return Section(
        "surrogate",
        "Surrogate",
        "Of the runs, one part after another was left out and predicted by a surrogate fitted to "
        "the others; the surrogate itself is fitted to all.",
        _differences(runs, analysis) if fitted and "first_order" in analysis else [],
        [Table(caption, head, rows)],
        ["surrogate_validation", SURROGATE.figure],
        index_tables(runs, analysis, SURROGATE) if fitted else [],
    )


def _differences(runs: xr.Dataset, analysis: xr.Dataset) -> list[str]:
    """Return one sentence per response and order whose two estimates do not overlap."""
    sentences = []
    meanings = np.array(measures.meanings(analysis))
    for name in analysed(runs, analysis):
        for order in SOBOL.measures_in(analysis):
            sampled = measures.index(analysis, order.name, name)
            fitted = measures.index(analysis, f"surrogate_{order.name}", name)
            apart = np.abs(sampled.values - fitted.values) > sampled.margins + fitted.margins
            if apart.any():
                response = labels.title(name)
                sentences.append(
                    f"{response}: the {order.label.replace(' ', '-')} indices of the runs and of "
                    "the surrogate differ by more than their intervals for "
                    f"{labels.listing(meanings[apart].tolist())}."
                )
    return sentences


def _ranks(runs: xr.Dataset, analysis: xr.Dataset, family: Family) -> Table:
    """Return one row per response: the rank of each parameter, a range where intervals overlap."""
    measure = family.ranked_by(analysis)
    rows: list[Row] = []
    for name in analysed(runs, analysis):
        index, row = measures.index(analysis, measure.name, name), [named(analysis, name)]
        for number, (best, worst) in enumerate(index.ranks):
            text = "numerical" if index.numerically_lost[number] else "noise"
            if not np.isfinite(index.values[number]):
                text = "undefined"
            elif index.significant[number]:
                text = str(best) if best == worst else f"{best}–{worst}"
            row.append(Cell(text, "number" if index.significant[number] else "muted"))
        rows.append(row)
    dummy = " or the dummy" if f"dummy_{measure.name}" in analysis else ""
    explained = f"noise: not distinguishable from zero{dummy}"
    if f"{measure.name}_numerical" in analysis:
        explained += "; numerical: not distinguishable from its numerical error"
    caption = f"Ranks of the parameters by {family.title}, {measure.label} ({explained})"
    meanings = _meanings(analysis, "sensitivity_verdict")
    return Table(caption, ["Response", *_parameters(analysis)], rows, meanings=meanings)


def _parameters(analysis: xr.Dataset) -> list[str]:
    return list(map(labels.sentence, measures.meanings(analysis)))


def _meanings(analysis: xr.Dataset, verdicts: str) -> list[tuple[str, str]]:
    flags = access.occurring(analysis.get(verdicts, xr.DataArray()))
    return [(flag.words, flag.meaning) for flag in flags if flag.meaning]


def _share(value: float, margin: float) -> str:
    """Return a share with the half-width of its interval."""
    decimals = decimals_of(value, margin)
    within = f"± {100 * margin:.{decimals}f}" if margin >= 0.0005 else uncertainty(margin)
    return f"{100 * value:.{decimals}f} % ({within})"


def decimals_of(value: float, margin: float) -> int:
    """Return the decimals of a share in per cent: none where it and its half-width are large."""
    return 0 if margin >= _COARSE and value >= _SMALL else 1


def index_tables(runs: xr.Dataset, analysis: xr.Dataset, family: Family) -> list[Table]:
    """Return one table per measure: responses by parameters, index ± half-width; the dummy last."""
    tables = []
    judged = verdict_name(analysis, lambda record: record.family == family)
    for measure in family.measures_in(analysis):
        dummy = f"dummy_{measure.name}"
        rows: list[Row] = []
        for name in analysed(runs, analysis):
            index = measures.index(analysis, measure.name, name)
            written = partial(in_units, runs[name]) if family is MORRIS else with_margin
            row = [named(analysis, name, judged)]
            columns = index.values, index.margins, index.significant, index.numerically_lost
            details = _p_values(analysis.sel(response=name), measure)
            for value, margin, significant, lost, detail in zip(*columns, details, strict=True):
                kind = "number" if significant else "muted"
                detail = "below numerical error" if lost else detail
                row.append(Cell(written(value, margin), kind, detail))
            if dummy in analysis:
                row.append(replace(_index(analysis.sel(response=name), dummy), kind="muted"))
            rows.append(row)
        head = ["Response", *_parameters(analysis)]
        if dummy in analysis:
            head.append("Dummy parameter")
        tables.append(Table(_caption(f"{family.title}, {measure.label}", analysis), head, rows))
    return tables


def _p_values(indices: xr.Dataset, measure: Measure) -> list[str]:
    """Return the p-value of independence of each parameter, "" for indices that have none."""
    values = indices.get(f"{measure.name}_p_value")
    if values is None:
        return [""] * indices.sizes["parameter"]
    return [
        f"p = {labels.number(value, 2)}" if np.isfinite(value) else "" for value in values.values
    ]


def second_order(runs: xr.Dataset, analysis: xr.Dataset) -> Table:
    """Return one row per pair of parameters, one column per response; noise is grey."""
    names, shown = measures.meanings(analysis), analysed(runs, analysis)
    rows: list[Row] = []
    for first, second in combinations(range(len(names)), 2):
        pair = f"{names[first]} and {names[second]}"
        indices = analysis.isel(parameter=first, other_parameter=second)
        cells = (_index(indices.sel(response=name), "second_order") for name in shown)
        rows.append([Cell(labels.sentence(pair)), *cells])
    head = ["Pair", *(labels.title(name) for name in shown)]
    return Table(_caption("Second-order Sobol indices", analysis), head, rows)


def _index(indices: xr.Dataset, name: str) -> Cell:
    """Return one index with its half-width, grey unless it exceeds that."""
    value, margin = float(indices[name]), float(indices.get(f"{name}_interval", np.inf))
    return Cell(with_margin(value, margin), "number" if abs(value) > margin else "muted")


def _caption(title: str, analysis: xr.Dataset) -> str:
    return f"{title}, with half-widths of the {access.confidence(analysis)} intervals"


def named(analysis: xr.Dataset, response: str, verdict: str = "sensitivity_verdict") -> Cell:
    """Return the response, with its verdict of that name where it is a warning."""
    return _judged(response, access.verdict(analysis, verdict, response))


def _judged(name: str, verdict: access.StatedVerdict | None) -> Cell:
    text = verdict.words if verdict and not verdict.sound else ""
    return Cell(labels.title(name), "warning" if text else "", text)


def with_margin(value: float, margin: float) -> str:
    """Return a number without unit and the half-width of its interval: "0.71 ± 0.03"."""
    if not np.isfinite(value):
        return "undefined"
    if max(abs(value), margin) < _LEAST:
        return f"below {_LEAST}"
    decimals = 3 if margin < _FINE else 2
    text = f"{round(value, decimals) + 0.0:.{decimals}f}".replace("-", "−")
    return f"{text} ± {margin:.{decimals}f}" if np.isfinite(margin) else text


def uncertainty(share: float) -> str:
    """Return a relative uncertainty in per cent, "± 1.5 %", or its bound if tiny or vast."""
    if share >= 1:
        return "as large as the value, or larger"
    return f"± {labels.percent(share)}" if share >= _TINY else f"below {labels.percent(_TINY)}"


def in_units(response: xr.DataArray, value: float, margin: float = np.inf) -> str:
    """Return an effect in the response's display unit: "12.3 kN ± 0.4"."""
    if not np.isfinite(value):
        return "undefined"
    text = labels.amount(response, value, 3)
    width = labels.number(float(display(response)(margin)), 2)
    return f"{text} ± {width}" if np.isfinite(margin) else text


def _bounded(share: float) -> str:
    return "not usable: the error may be larger" if share > 1 else labels.percent(share)


def numerical_sections(runs: xr.Dataset, analysis: xr.Dataset) -> list[Section]:
    """Return the section on the numerical uncertainty, or none where the analysis has none."""
    based = "numerical_from" in analysis
    if not based and not any(key in analysis for key in _OF_RESPONSES):
        return []
    occurring = access.occurring(analysis.get("numerical_from", xr.DataArray()))
    lead = _LEAD + "".join(_BASES.get(flag.flag, "") for flag in occurring)
    orders = {
        f"{order.name}_numerical": f"Largest numerical error of the indices of {order.label}"
        for order in SOBOL.measures
        if f"{order.name}_numerical" in analysis
    }
    rows: list[Row] = []
    for name in analysed(runs, analysis):
        statistics = analysis.sel(response=name)
        cells = [largest(statistics, key, _bounded) for key in _OF_RESPONSES]
        cells += [largest(statistics, key, labels.number) for key in orders]
        basis = access.verdict(analysis, "numerical_from", name)
        rows.append([named(analysis, name), *cells, *([Cell(basis.words)] if basis else [])])
    head = ["Response", *_OF_RESPONSES.values(), *orders.values(), *(["Basis"] if based else [])]
    table = Table("Numerical uncertainty of each response", head, rows)
    return [Section("numerical", "Numerical uncertainty", lead, tables=[table])]
