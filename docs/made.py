"""Pages that are made from real runs when the site is built: gallery and verification."""

from __future__ import annotations

import json
import os
import re
import shutil
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from itertools import islice
from multiprocessing import get_context
from pathlib import Path
from typing import NamedTuple

import datasets
from PIL import Image

import impactlab as il
from impactlab.fem3d.figures import witness
from impactlab.figures.draw import OVERVIEW, draw, draw_all
from impactlab.figures.record import listed
from impactlab.files import read_netcdf, write_netcdf
from impactlab.report.page import leading
from impactlab.report.questions import answers_beside
from impactlab.report.results import FINDINGS
from impactlab.report.verification import uncertainty
from impactlab.study import steps
from impactlab.study.schema.readers import read_verification
from impactlab.verification.outcomes import unpacked

DOCS = Path(__file__).parent
ROOT = DOCS.parent
GALLERY = DOCS / "gallery"
STORED = DOCS / "stored"
"""Answers and pictures of DEAR studies; `make stored` renews them."""
DEAR = ("sobol_large", "witness", "witness_mesh", "witness_parts", "witness_swing")
"""Studies of more than a minute of one core, which the site does not solve."""
MOST = 6
"""Figures stored of a study, the first ones of its report."""
INCH = 140
"""Pixels of a page per inch of a figure: as wide as the text, or half as wide."""
WORKERS = min(4, os.cpu_count() or 1)
SHOWN = ("velocity", "contact_laws", "shear", "strike_position", "supports", "strikes", "layers",
         "material", "model_form", "sobol_slow", "sobol", "sobol_fast", "sobol_large", "rare_dent",
         "multifidelity",
         "discretisation", "time_step", "ishigami", "smoke")  # fmt: skip
FIRST = {
    "contact_laws": "contact_laws",
    "fig05": "force_history",
    "fig07": "force_indentation",
    "fig08": "contact_duration",
    "fig10": "plastic_strain",
    "rare_dent": "likeliest_way",
    "shear": "shear",
    "velocity": "contact_duration",
    "witness": "witness",
    "witness_parts": "witness_parts",
    "witness_swing": "witness",
}
"""Figures that come first on a page, where the report begins with another one."""
GROUPS = {
    "Impacts, tolerances and grids": lambda name: not name.startswith(("fig", "witness")),
    "The figures of the source paper": lambda name: name.startswith("fig"),
    "Beside 3-D finite elements": lambda name: name.startswith("witness"),
}


def make() -> None:
    """Write docs/gallery, the tables of docs/verification.md and docs/datasets.md."""
    GALLERY.mkdir(exist_ok=True)
    paths = sorted((ROOT / "studies").glob("*.yaml"))
    with ProcessPoolExecutor(WORKERS, mp_context=get_context("spawn")) as pool:
        pages = pool.submit(_verification), pool.submit(_datasets)
        cards = pool.map(_study, [each for each in paths if each.stem != "verification"])
        _index(dict(cards))
        for page in pages:
            page.result()


def _current(made: Path, *files: Path) -> bool:
    """Return whether a page is younger than what it was made from: these files, and the program."""
    used = [Path(__file__), *files, *(ROOT / "impactlab").rglob("*.py")]
    return made.exists() and made.stat().st_mtime > max(each.stat().st_mtime for each in used)


class Shown(NamedTuple):
    """The part of a page that comes from runs: sentences, captions by figure, their folder.

    further: the sentences that stand folded below the figures, on the pages of a comparison.
    """

    answers: list[str]
    further: list[str]
    captions: dict[str, dict[str, str]]
    pictures: Path
    remark: str = ""


def _study(path: Path) -> tuple[str, tuple[str, str]]:
    """Write the page of a study; return its name, title, and picture for its card ("": none)."""
    study, page = il.Study.from_yaml(path, results=ROOT / "results"), GALLERY / f"{path.stem}.md"
    if _current(page, path, *study.folder.glob("runs.nc"), *STORED.glob(f"{path.stem}/*")):
        pictures = re.findall(r"{figure} (.*)", page.read_text(encoding="utf-8"))
        return path.stem, (study.title, pictures[0] if pictures else "")
    done = study.status() if path.stem in DEAR else None
    dear = path.stem in DEAR and (done is None or done.done < done.runs)
    shown = _stored(study) if dear else _solved(study)
    lines = [f"# {study.title}", study.declared.description or "", ""]
    lines += ["**The answer**\n"] * bool(shown.answers)
    lines += [*(f"- {each}" for each in shown.answers), "", shown.remark, ""]
    for at, (name, caption) in enumerate(shown.captions.items()):
        target = GALLERY / path.stem / f"{name}.png"
        target.parent.mkdir(exist_ok=True)
        shutil.copyfile(shown.pictures / f"{name}.png", target)
        with Image.open(target) as picture:
            width = picture.width / picture.info["dpi"][0] * INCH
        lines += [
            *([f"::::{{dropdown}} {caption['title']}"] if at else []),
            f":::{{figure}} {path.stem}/{name}.png",
            f":alt: {caption['alt']}",
            f":width: {width:.0f}px\n",
            caption["caption"],
            ":::\n",
            "::::\n" if at else "",
        ]
    if shown.further:
        lines += ["::::{dropdown} All responses, and their convergence"]
        lines += [*(f"- {each}" for each in shown.further), "::::\n"]
    lines += [
        "## The file behind it\n",
        f"`impactlab go studies/{path.name}` solves it and writes its report, with every figure, "
        "table and doubt:\n",
        f"```{{literalinclude}} ../../studies/{path.name}\n:language: yaml\n```\n",
    ]
    page.write_text("\n".join(lines), encoding="utf-8")
    first = next(iter(shown.captions), None)
    return path.stem, (study.title, f"{path.stem}/{first}.png" if first else "")


def _solved(study: il.Study, workers: int = 1) -> Shown:
    """Solve and draw a study; its leading figure, or that of FIRST, comes first.

    The answer of beam models beside 3-D finite elements is how much they differ.
    """
    runs, pictures = study.run(workers=workers), ROOT / "build" / "gallery" / study.name
    analysis = study.analyse()
    draw_all(runs, analysis, pictures, partial(draw, formats=["png"]))
    answers, compared = il.answers(runs, analysis), witness.findings(runs, analysis)
    captions = listed(pictures)
    for *_, page in answers_beside(runs, study.folder):
        drawings = (study.folder / page).with_suffix("") / "figures"
        for name, caption in listed(drawings).items():
            captions[name] = caption
            shutil.copyfile(drawings / f"{name}.png", pictures / f"{name}.png")
    first = FIRST.get(study.name) or leading(captions)
    for sentence in compared:  # the answer is not said again beneath the figure
        captions[first]["caption"] = captions[first]["caption"].replace(f" {sentence}", "")
    return Shown(
        compared or answers,
        answers if compared else [],
        {first: captions[first]} | captions,
        pictures,
    )


def _stored(study: il.Study) -> Shown:
    """Return what is stored of a study: nothing where the file has changed since."""
    again = f"`make stored STORED={study.name}`"
    file = STORED / study.name / "shown.json"
    kept = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
    if kept.get("study_sha256") != study.declared.sha256:
        remark = (
            f":::{{note}}\nIt takes longer to solve than this site takes to build. {again} solves "
            "it; build the site again, and its answer and figures are here.\n:::\n"
        )
        return Shown([], [], {}, file.parent, remark)
    remark = (
        f"Solved on {kept['solved']} by impactlab {kept['impactlab']}, not with this site: "
        f"it takes longer. {again} renews it.\n"
    )
    return Shown(kept["answers"], kept["further"], kept["figures"], file.parent, remark)


def store(names: Sequence[str]) -> None:
    """Solve studies and keep what is shown of them; by default DEAR ones that are not current."""
    for name in names or DEAR:
        study = il.Study.from_yaml(ROOT / "studies" / f"{name}.yaml", results=ROOT / "results")
        if not names and _stored(study).captions:
            continue
        shown, folder = _solved(study, WORKERS), STORED / name
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        captions = dict(islice(shown.captions.items(), MOST))
        for each in captions:
            with Image.open(shown.pictures / f"{each}.png") as picture:
                half = picture.convert("RGB").reduce(2)
                few = half.quantize(64, dither=Image.Dither.NONE)
                dpi = picture.info["dpi"][0] / 2
                few.save(folder / f"{each}.png", dpi=(dpi, dpi))
        kept = {
            "study_sha256": study.declared.sha256,
            "solved": read_netcdf(study.folder / "runs.nc", "runs").attrs["created"][:10],
            "impactlab": il.__version__,
            "answers": shown.answers,
            "further": shown.further,
            "figures": captions,
        }
        text = json.dumps(kept, indent=1, ensure_ascii=False) + "\n"
        (folder / "shown.json").write_text(text, encoding="utf-8")


def _index(cards: dict[str, tuple[str, str]]) -> None:
    order = [*SHOWN, *(name for name in cards if name not in SHOWN)]
    lines = [
        "# Gallery\n",
        "Each study in `studies/` with its answer, its figures and the file behind it. "
        "What you see was solved when this site was built, or on the day that its page states.\n",
    ]
    for heading, belongs in GROUPS.items():
        lines += [f"## {heading}\n", "::::{grid} 1 2 2 3", ":gutter: 3\n"]
        for name in filter(belongs, order):
            title, picture = cards[name]
            lines += [f":::{{grid-item-card}} {title}", f":link: {name}", ":link-type: doc"]
            lines += [f":img-top: {picture}", f":img-alt: {title}"] if picture else []
            lines += [
                "" if picture else "\nThe file alone: it takes longer than this site.",
                ":::",
            ]
        lines.append("::::\n")
    lines += ["```{toctree}", ":hidden:\n", *order, "```"]
    (GALLERY / "index.md").write_text("\n".join(lines), encoding="utf-8")


def _datasets() -> None:
    page = GALLERY / "_datasets.md"
    if not _current(page, DOCS / "datasets.py"):
        datasets.make(page)


def _verification() -> None:
    file, page = ROOT / "studies" / "verification.yaml", GALLERY / "_checks.md"
    if _current(page, file):
        return
    declared = read_verification(file)
    folder = steps.results_folder(declared.name, ROOT / "results")
    folder.mkdir(parents=True, exist_ok=True)
    findings = steps.check(declared)
    write_netcdf(findings, folder / "findings.nc", "findings")
    FINDINGS.draw(findings, folder / "figures")
    shutil.copyfile(folder / "figures" / f"{OVERVIEW}.png", GALLERY / "verification.png")
    outcomes = unpacked(findings)
    total = sum(len(each.finding.comparisons) for each in outcomes)
    passed = sum(each.passed for outcome in outcomes for each in outcome.finding.comparisons)
    lines = [
        f"**{passed} of {total} comparisons in {len(outcomes)} checks passed** when this site was "
        "built.\n",
        "| check | comparisons | nearest to its tolerance | ours | independent | its uncertainty | "
        "of tolerance |",
        "|---|---|---|---|---|---|---|",
    ]
    for each in outcomes:
        row = [each.title, str(len(each.finding.comparisons)), *[""] * 5]
        if (worst := each.worst) is not None:
            unit = "" if worst.units == "1" else f" {worst.units}"
            row[2] = f"{worst.quantity}, {worst.where}"
            row[3:5] = (f"{value:.5g}{unit}" for value in (worst.ours, worst.independent))
            absolute = worst.measure == "absolute"
            limit = f"{worst.tolerance:.2g}{unit}" if absolute else f"{100 * worst.tolerance:.2g} %"
            row[5] = uncertainty(worst)
            row[6] = f"{100 * worst.ratio:.0f} % of {limit}"
        row[0] += "" if each.verdict == "passed" else f": **{each.verdict}**"
        lines.append("| " + " | ".join(cell.replace("|", r"\|") for cell in row) + " |")
    lines += ["", ":::{dropdown} Where the independent values come from"]
    lines += [
        f"- {each.title}: {each.source}. Uncertainty ({each.reference}): {each.basis}."
        for each in outcomes
    ]
    lines += [":::"]
    page.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    store(sys.argv[1:])
