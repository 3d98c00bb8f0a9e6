"""Pages that are made from real runs when the site is built: gallery and verification."""

from __future__ import annotations

import os
import re
import shutil
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import impactlab as il
from impactlab.figures.draw import OVERVIEW, listed
from impactlab.files import read_netcdf, write_netcdf
from impactlab.report.page import leading
from impactlab.report.results import FINDINGS
from impactlab.study import steps
from impactlab.study.schema.files import read_verification
from impactlab.verification.stored import unpacked

DOCS = Path(__file__).parent
ROOT = DOCS.parent
GALLERY = DOCS / "gallery"
SECONDS = 8.0
"""Estimated core-seconds up to which a study is solved for the site."""
ALWAYS = ("sobol",)
"""Solved whatever its estimate, which is half a minute too high."""
WORKERS = min(4, os.cpu_count() or 1)
SHOWN = ("velocity", "contact_laws", "shear", "material", "sobol_slow", "sobol", "sobol_fast",
         "sobol_large", "discretisation", "time_step", "ishigami", "smoke")  # fmt: skip
GROUPS = {
    "Impacts, tolerances and grids": lambda name: not name.startswith(("fig", "witness")),
    "The figures of the source paper": lambda name: name.startswith("fig"),
    "Beside 3-D finite elements": lambda name: name.startswith("witness"),
}


def make() -> None:
    """Write docs/gallery, the table of docs/verification.md."""
    GALLERY.mkdir(exist_ok=True)
    paths = sorted((ROOT / "studies").glob("*.yaml"))
    with ProcessPoolExecutor(WORKERS, mp_context=get_context("spawn")) as pool:
        checked = pool.submit(_verification)
        cards = pool.map(_study, [each for each in paths if each.stem != "verification"])
        _index(dict(cards))
        checked.result()


def _current(made: Path, *files: Path) -> bool:
    """Return whether a page is younger than what it was made from: these files, and the program."""
    used = [Path(__file__), *files, *(ROOT / "impactlab").rglob("*.py")]
    return made.exists() and made.stat().st_mtime > max(each.stat().st_mtime for each in used)


def _study(path: Path) -> tuple[str, tuple[str, str]]:
    """Write the page of a study; return its name, title, and picture for its card ("": none)."""
    study, page = il.Study.from_yaml(path, results=ROOT / "results"), GALLERY / f"{path.stem}.md"
    if _current(page, path, *study.folder.glob("runs.nc")):
        pictures = re.findall(r"{figure} (.*)", page.read_text(encoding="utf-8"))
        return path.stem, (study.title, pictures[0] if pictures else "")
    done = study.status()
    there = done is not None and done.done + done.failed == done.runs
    lines = [f"# {study.title}", study.declared.description or "", ""]
    picture = ""
    if there or path.stem in ALWAYS or study.estimate(workers=1).seconds <= SECONDS:
        runs = study.run(workers=1)
        study.figures()
        analysis = read_netcdf(study.folder / "analysis.nc", "analysis")
        lines += ["**The answer**\n", *(f"- {each}" for each in il.answers(runs, analysis)), ""]
        captions = listed(study.folder / "figures")
        first = leading(captions)
        picture = f"{path.stem}/{first}.png"
        for name in [first, *(each for each in captions if each != first)]:
            target = GALLERY / path.stem / f"{name}.png"
            target.parent.mkdir(exist_ok=True)
            shutil.copyfile(study.folder / "figures" / f"{name}.png", target)
            folded = [f"::::{{dropdown}} {captions[name]['title']}"] if name != first else []
            lines += [
                *folded,
                f":::{{figure}} {path.stem}/{name}.png",
                f":alt: {captions[name]['alt']}\n",
                captions[name]["caption"],
                ":::\n",
                "::::\n" if folded else "",
            ]
    else:
        lines.append(
            f":::{{note}}\nIt takes longer to solve than this site takes to build. "
            f"`make study STUDIES={path.stem}` solves it; build the site again, and its answer "
            "and figures are here.\n:::\n"
        )
    lines += [
        "## The file behind it\n",
        f"`impactlab go studies/{path.name}` solves it and writes its report, with every figure, "
        "table and doubt:\n",
        f"```{{literalinclude}} ../../studies/{path.name}\n:language: yaml\n```\n",
    ]
    page.write_text("\n".join(lines), encoding="utf-8")
    return path.stem, (study.title, picture)


def _index(cards: dict[str, tuple[str, str]]) -> None:
    order = [*SHOWN, *(name for name in cards if name not in SHOWN)]
    lines = [
        "# Gallery\n",
        "Each study in `studies/` with its answer, its figures and the file behind it. "
        "What you see was solved when this site was built.\n",
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
        "| check | comparisons | nearest to its tolerance | ours | independent | of tolerance |",
        "|---|---|---|---|---|---|",
    ]
    for each in outcomes:
        row = [each.title, str(len(each.finding.comparisons)), "", "", "", ""]
        if (worst := each.worst) is not None:
            unit = "" if worst.units == "1" else f" {worst.units}"
            row[2] = f"{worst.quantity}, {worst.where}"
            row[3:5] = (f"{value:.5g}{unit}" for value in (worst.ours, worst.independent))
            row[5] = f"{worst.ratio:.0%}"
        row[0] += "" if each.verdict == "passed" else f": **{each.verdict}**"
        lines.append("| " + " | ".join(cell.replace("|", r"\|") for cell in row) + " |")
    lines += ["", ":::{dropdown} Where the independent values come from"]
    lines += [*(f"- {each.title}: {each.source}" for each in outcomes), ":::"]
    page.write_text("\n".join(lines) + "\n", encoding="utf-8")
