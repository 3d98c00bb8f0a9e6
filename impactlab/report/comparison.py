"""The comparison of several studies on one page: what differs, and what that changes."""

import os
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

import numpy as np
import xarray as xr

from impactlab.analysis.differences import METHOD
from impactlab.figures import access, labels
from impactlab.figures.record import LEAD
from impactlab.figures.studies import (
    StudyResults,
    common_display,
    draw_studies,
    rows_of,
    shared_family,
    shared_responses,
)
from impactlab.files import read_netcdf, write_netcdf
from impactlab.methods.record import Family, Measure
from impactlab.model.checks import did_you_mean
from impactlab.model.parameters import PARAMETERS
from impactlab.provenance import provenance
from impactlab.report import changes
from impactlab.report.answer import answers
from impactlab.report.page import Cell, Row, Section, Table, described, pictures, write_page
from impactlab.report.results import COMPARISON, RUNS, open_stored, stored_files
from impactlab.study.schema.yaml_file import read_mapping
from impactlab.variables import of_function

_UNCOMPARED = ("title", "description")
_ABSENT = "–"


def study_folder(study: str, results: Path) -> Path:
    """Return the folder of a study's results, by its name, its file or the folder itself.

    Raises FileNotFoundError, naming the nearest study with results, where there is none.
    """
    folder = results / Path(study).stem
    if not folder.is_dir():
        made = sorted(path.parent.name for path in results.glob("*/runs.nc"))
        near = did_you_mean(folder.name, made)
        listed = f"; {results}/ has {', '.join(made)}" if made and not near else near
        raise FileNotFoundError(
            f"{study}: there are no results in {folder}{listed or ': make them with impactlab go'}"
        )
    return folder


def compare_results(folders: Sequence[Path], output: Path | None = None) -> xr.Dataset:
    """Compare the stored results of studies, in their order, and return the comparison.

    Writes comparison.nc, figures/ and report.html to `output`, a folder beside the first by
    default. The attribute `answer` of the comparison holds its findings, a line each. Raises
    FileNotFoundError for a study without results, ValueError where studies cannot be compared.
    """
    names = [folder.name for folder in folders]
    if len(names) < 2 or len(set(names)) < len(names):
        raise ValueError(f"{', '.join(names)}: name two or more studies, each of them once")
    output = output or folders[0].parent / f"compare-{'-'.join(names)}"[:100]
    if any((output / name).exists() for name in ("runs.nc", "findings.nc")):
        raise ValueError(f"{output}: holds the results of a study: choose another folder")
    with ExitStack() as stack:
        opened = [stack.enter_context(open_stored(stored_files(folder))) for folder in folders]
        for name, (kind, _) in zip(names, opened, strict=True):
            if kind is not RUNS:
                raise ValueError(f"{name}: is a verification, without runs: take it out")
        solved = on_common_dimensions([datasets[0] for _, datasets in opened])
        texts = tell_apart(names, solved)
        studies = [
            StudyResults(name, label, runs, datasets[1])
            for name, label, runs, (_, datasets) in zip(names, texts, solved, opened, strict=True)
        ]
        _check(studies)
        found = changes.findings(studies)
        comparison = _dataset(studies, found).assign_attrs(
            provenance(),
            study=output.name,
            title=f"Side by side: {_subject(studies)}",
            studies=names,
            answer="\n".join(found.sentences),
        )
        sources = [dataset for study in studies for dataset in (study.runs, study.analysis)]
        write_netcdf(comparison, output / COMPARISON, "comparison", *sources)
        comparison = read_netcdf(output / COMPARISON, "comparison")
        draw_studies(studies, found.lead, comparison, output / "figures")
        _write_page(studies, comparison, found, folders, output)
    return comparison


def on_common_dimensions(runs: Sequence[xr.Dataset]) -> list[xr.Dataset]:
    """Return grids whose dimensions are the parameters that any of them varies; samples as are.

    A parameter that has a single value in all of them is held, one that only others vary is a
    dimension with its one value.
    """
    if any(map(access.is_sample, runs)):
        return list(runs)
    sizes = [(dim, grid.sizes[dim]) for grid in runs for dim in access.design_dims(grid)]
    varied = {dim for dim, size in sizes if size > 1}
    common = []
    for grid in runs:
        held = grid.squeeze([dim for dim in access.design_dims(grid) if dim not in varied])
        missing = [n for n in varied if n in held.coords and n not in held.dims]
        common.append(held.expand_dims(missing))
    return common


def _check(studies: Sequence[StudyResults]) -> None:
    """Raise ValueError unless studies are of one kind and share a response."""
    first, *others = studies
    kinds = {study.name: access.is_sample(study.runs) for study in studies}
    for study in others:
        if kinds[study.name] != kinds[first.name]:
            words = {True: "a random sample", False: "a grid"}
            each = labels.listing([f"{name} is {words[kind]}" for name, kind in kinds.items()])
            raise ValueError(f"{each}: compare studies of the same kind (key sampling.method)")
    if not shared_responses(studies):
        each = "; ".join(f"{s.name} has {', '.join(access.responses(s.runs))}" for s in studies)
        raise ValueError(f"no response is in all of the studies ({each}): name one in each file")


def differing(runs: Sequence[xr.Dataset]) -> list[str]:
    """Return the parameters with one value in each study that is not the same in all of them."""
    if any(map(of_function, runs)):
        return []
    single = [n for n in PARAMETERS if all(n in r.coords and r[n].ndim == 0 for r in runs)]
    return [name for name in single if len({r[name].item() for r in runs}) > 1]


def tell_apart(names: Sequence[str], runs: Sequence[xr.Dataset]) -> list[str]:
    """Return a label per study: what differs of the impact, "5 m/s", or else its title or name."""
    varied = [name for name in differing(runs) if PARAMETERS[name].path[0] == "impact"]
    by_value = [", ".join(labels.brief(r[name], 0) for name in varied) for r in runs]
    titles = [str(r.attrs.get("title", "")) for r in runs]
    choices = ([by_value] if len(varied) in (1, 2) else []) + [titles]
    whole = (texts for texts in choices if all(texts) and len(set(texts)) == len(texts))
    return next(whole, list(names))


def _subject(studies: Sequence[StudyResults]) -> str:
    """Return what the studies differ in: "impact velocity 1 m/s, 5 m/s and 15 m/s"."""
    runs = [study.runs for study in studies]
    names, texts = differing(runs), [study.label for study in studies]
    if not names or not texts[0].startswith(labels.brief(runs[0][names[0]], 0)):
        return labels.listing(texts)
    unit = labels.unit(runs[0][names[0]])
    if all(text.endswith(unit) for text in texts):
        texts = [text.removesuffix(unit) for text in texts[:-1]] + texts[-1:]
    return f"{labels.parameter(runs[0][names[0]])} {labels.listing(texts)}"


def _dataset(studies: Sequence[StudyResults], found: changes.Findings) -> xr.Dataset:
    """Return the differences on (response, pair, measure, parameter), and indices of each study."""
    labelled = xr.Dataset(coords={"study": [study.label for study in studies]})
    if not found.by_response:
        return labelled
    pairs = [entry.set_index(pair=["first", "second"]) for entry in found.by_response.values()]
    responses = xr.Variable("response", [*found.by_response])
    joined = xr.concat(pairs, responses, join="outer").reset_index("pair")
    significant = joined["is_significant"].fillna(0).astype(np.int8)
    joined["is_significant"] = significant.assign_attrs(long_name="1: beyond interval and error")
    return joined.merge(labelled)


def _differences(studies: Sequence[StudyResults]) -> Table:
    """Return one row per key that the study files state differently, then per value as solved."""
    files = [_flat(read_mapping(str(s.runs.attrs["study_text"]), s.name)) for s in studies]
    keys = [key for key in dict.fromkeys(key for file in files for key in file)]
    rows: list[Row] = []
    stated = set()
    for key in keys:
        values = [file.get(key, _ABSENT) for file in files]
        if key.split(".")[0] not in _UNCOMPARED and len(set(values)) > 1:
            rows.append([labels.sentence(_meaning(key)), *values, Cell(key, "muted")])
            stated.add(key)
    for name in differing([study.runs for study in studies]):
        key = ".".join(PARAMETERS[name].path)
        if not stated & {key, f"sampling.parameters.{name}"}:
            texts = [labels.brief(study.runs[name], 0) for study in studies]
            meaning = labels.sentence(labels.parameter(studies[0].runs[name]))
            rows.append([meaning, *texts, Cell(f"{key} (as solved)", "muted")])
    head = ["Difference", *(study.label for study in studies), "Key"]
    return Table(
        "Keys of the study files with different values; all others are the same", head, rows
    )


def _flat(content: object, path: tuple[str, ...] = ()) -> dict[str, str]:
    """Map dotted keys of a study file to their values as text."""
    if not isinstance(content, dict):
        entries = content if isinstance(content, list) else [content]
        texts = [str(entry) for entry in entries]
        words = [labels.response(text) for text in texts] if isinstance(content, list) else texts
        return {".".join(path): ", ".join(words)}
    return {
        key: text
        for step, value in content.items()
        for key, text in _flat(value, (*path, str(step))).items()
    }


def _meaning(key: str) -> str:
    """Return a key in words: that of a parameter by its meaning, others as they read."""
    for name, entry in PARAMETERS.items():
        if key == ".".join(entry.path):
            return entry.long_name
        prefix = f"sampling.parameters.{name}"
        if key == prefix or key.startswith(f"{prefix}."):
            rest = key.removeprefix(prefix).strip(".").replace("_", " ")
            return f"{entry.long_name}, {rest}" if rest else entry.long_name
    *above, last = key.replace("_", " ").split(".")
    return f"{last} ({', '.join(above)})" if above else last


def _studies(studies: Sequence[StudyResults], folders: Sequence[Path], output: Path) -> Table:
    """Return one row per study: its report, title and answer."""
    rows: list[Row] = []
    for study, folder in zip(studies, folders, strict=True):
        report = folder / "report.html"
        link = os.path.relpath(report, output) if report.exists() else ""
        size, failed = RUNS.counts(study.runs)
        title = str(study.runs.attrs.get("title", ""))
        answer = answers(study.runs, study.analysis)[0]
        rows.append(
            [Cell(study.name, link=link), title, answer, f"{size}; {failed or 'none failed'}"]
        )
    return Table("What each study answers by itself", ["Study", "Title", "Answer", "Runs"], rows)


def _indices(
    studies: Sequence[StudyResults], family: Family, found: changes.Findings, measure: Measure
) -> Table:
    """Return one row per response and parameter: the index of each study, and what changes.

    A parameter that matters in no study for the response has no row.
    """
    rows: list[Row] = []
    for response, dataset in found.by_response.items():
        shown, _ = rows_of(studies, measure.name, [response])
        for change in changes.largest(dataset, measure.name):
            if change.parameter not in shown:
                continue
            cells = []
            for study in studies:
                if study.is_usable(response):
                    key = study, family, measure.name, response, change.parameter
                    cells.append(Cell(changes.written(*key), "number"))
                else:
                    cells.append(Cell("not usable", "warning"))
            text, detail = changes.difference_text(studies, family, response, change)
            verdict = Cell(text, "number" if change.is_significant else "muted", detail)
            parameter = labels.sentence(changes.meaning(studies, change.parameter))
            rows.append([labels.title(response), parameter, *cells, verdict])
    head = ["Response", "Parameter", *(study.label for study in studies), "Difference"]
    caption = f"{family.title}, {measure.label}; parameters that matter in no study are left out"
    return Table(caption, head, rows)


def _responses(studies: Sequence[StudyResults]) -> Table:
    """Return one row per response: its mean and percentiles in a sample, its range in a grid."""
    sample, rows = access.is_sample(studies[0].runs), list[Row]()
    for name in shared_responses(studies):
        unit, cells = common_display(studies, name), []
        for study in studies:
            values = access.usable(study.runs, name).values
            values = unit(values[np.isfinite(values)])
            if not values.size:
                cells.append(Cell("missing", "warning"))
                continue
            ends = np.quantile(values, [0.05, 0.95]) if sample else values
            span = labels.span(ends, 3)
            mean = labels.number(float(values.mean()), 3)
            cells.append(Cell(mean, "number", span) if sample else Cell(span, "number"))
        rows.append([labels.title(name), unit.symbol or "–", *cells])
    caption = "Mean over the runs; below it the 5th to the 95th percentile" if sample else "Ranges"
    return Table(caption, ["Response", "Unit", *(study.label for study in studies)], rows)


def _write_page(
    studies: Sequence[StudyResults],
    comparison: xr.Dataset,
    found: changes.Findings,
    folders: Sequence[Path],
    output: Path,
) -> None:
    figures = pictures(output / "figures", made_from=comparison)
    sample, family = access.is_sample(studies[0].runs), shared_family(studies)
    sections = [
        Section("differences", "What differs", tables=[_differences(studies)]),
        Section("studies", "The studies", tables=[_studies(studies, folders, output)]),
    ]
    if family and found.by_response:
        confidence = access.confidence(studies[0].analysis)
        ranked, *others = sorted(
            changes.common_measures(studies, family),
            key=lambda measure: measure != family.ranked_by(studies[0].analysis),
        )
        content = Section(
            "indices",
            f"{family.title} side by side",
            METHOD.format(confidence=confidence),
            tables=[_indices(studies, family, found, ranked)],
            figures=["compared_indices"],
            folded=[_indices(studies, family, found, measure) for measure in others],
        )
        sections.insert(1, content)
    title = "Distributions side by side" if sample else "Responses side by side"
    shown = ["compared_distributions"] if sample else ["compared_responses"]
    content = Section("responses", title, tables=[_responses(studies)], figures=shown)
    sections.insert(-1, content)
    names = " ".join(study.name for study in studies)
    write_page(
        "report.html.j2",
        output / "report.html",
        **described(comparison, "comparison"),
        headline=found.headline,
        answers=found.lines,
        note="",
        leading=figures.pop(LEAD, None),
        facts=[f"{len(studies)} studies"],
        ending="",
        pictures=figures,
        files="figures",
        sections=sections,
        reproduce=[
            (f"impactlab compare {names} --output {output}", "compares these results again"),
            ("make study", "reproduces all results, figures and reports"),
        ],
    )
