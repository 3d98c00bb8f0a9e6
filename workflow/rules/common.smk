# What the rules share: what the program says of the studies, and the sources of each step.
import importlib.util
import json
import logging
import os
import subprocess
import sys
import time
from pathlib import Path

from snakemake.exceptions import WorkflowError
from snakemake_interface_logger_plugins.common import LogEvent

include: "pace.smk"


class StepLines(logging.Handler):
    """Prints a line as each step begins: its study, and how long the rest takes."""

    def emit(self, record):
        event, now = getattr(record, "event", None), time.monotonic()
        if event == LogEvent.RUN_INFO:
            counts = {rule: n for rule, n in record.stats.items() if rule not in ("all", "total")}
            cores = workflow.resource_settings.cores or os.cpu_count()
            self.total, self.pace = sum(counts.values()), Pace(counts, recorded_seconds(), cores)
        elif event == LogEvent.JOB_FINISHED:
            self.pace.finish(record.job_id, now)
        elif event == LogEvent.JOB_INFO and record.rule_name != "all" and not workflow.dryrun:
            names = [record.wildcards.get(key, "") for key in ("study", "comparison")]
            study, left = "".join(names), self.pace.left(now)
            done = f"{len(self.pace.ratios)} of {self.total} done, " if self.pace.ratios else ""
            left = "" if left is None else f"about {duration(left)} left"
            self.pace.start(record.jobid, record.rule_name, study, now)
            begun = "; ".join(filter(None, [f"{done}{left}".rstrip(", "), study or "all studies"]))
            print(f"{begun}: {record.rule_name}", file=sys.stderr, flush=True)
        elif record.levelno >= logging.ERROR:
            where = ", see " + ", ".join(record.log) if getattr(record, "log", None) else ""
            print(f"{record.getMessage()}{where}", file=sys.stderr, flush=True)


def recorded_seconds():
    """Return what steps took in an earlier run, by rule and study."""
    files = [path for study in STUDIES for path in Path("results", study).glob("benchmarks/*.tsv")]
    return {(path.stem, path.parts[1]): first_number(path) for path in files}


def first_number(benchmark):
    """Return the seconds in a benchmark file of Snakemake."""
    return float(benchmark.read_text().splitlines()[1].split()[0])


if workflow.is_main_process:
    logging.getLogger("snakemake.logging").addHandler(StepLines())


def read_studies():
    """Return what `impactlab studies --json` says of each study file, by name.

    Snakemake reads this file again for every job: those on this machine inherit the answer.
    """
    said = os.environ.get("IMPACTLAB_STUDIES")
    if said is None:
        command = ["impactlab", "studies", "--json"]
        said = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout
        os.environ.update(IMPACTLAB_STUDIES=said)
    return {study["name"]: study for study in json.loads(said)}


def asked_studies(asked):
    """Return the names of `--config studies=...`; without it every study but smoke, a test."""
    if not asked:
        return [name for name in DESCRIBED if name != "smoke"]
    names = asked if isinstance(asked, list) else str(asked).replace(",", " ").split()
    if unknown := [name for name in names if name not in DESCRIBED]:
        raise WorkflowError(
            f"studies={','.join(unknown)}: there is no such study; the folder studies/ has "
            f"{', '.join(sorted(DESCRIBED))}"
        )
    return names


def comparable(comparisons):
    """Return the names of the comparisons whose studies are all among those to be made."""
    return [name for name, studies in comparisons.items() if set(studies) <= set(STUDIES)]


def has(study, *traits):
    """Return whether the program ascribes one of these traits to a study."""
    return not set(traits).isdisjoint(DESCRIBED.get(study, {}).get("traits", ()))


def code(*patterns):
    """Return the sources that a step depends on: when they change, the step is done again."""
    return sorted(str(path) for pattern in patterns for path in PACKAGE.glob(pattern))


def where(name, *traits):
    """Return an input function: the file `name` of a study that has such a trait, else nothing."""
    return lambda wildcards: [f"results/{wildcards.study}/{name}"] * has(wildcards.study, *traits)


def solving(wildcards):
    """Return the sources of the runs; the analysis is one where it decides on number or grid."""
    deciding = ["analysis/**/*.py"] * has(wildcards.study, "growing")
    deciding += ["analysis/convergence/*.py"] * has(wildcards.study, "auto")
    deciding += ["analysis/multifidelity*.py"] * has(wildcards.study, "multifidelity")
    solid = ["fem3d/**/*.py"] * has(wildcards.study, "fem3d")
    return code(*SOLVER, "study/**/*.py", *deciding, *solid)


def parts(wildcards):
    """Return what tells that the parts of a study are solved; a growing sample or table has none."""
    total = 0 if has(wildcards.study, "growing", "table") else PARTS
    return [f"results/{wildcards.study}/parts/{part}-of-{total}" for part in range(1, total + 1)]


PACKAGE = Path("impactlab")  # of the checkout; elsewhere that which is installed
if not PACKAGE.is_dir() and (spec := importlib.util.find_spec("impactlab")):
    PACKAGE = Path(spec.origin).parent
MODEL = ("variables.py", "model/*.py", "wings.py", "*/wing.py")
SOLVER = (*MODEL, "simulate.py", "solver/**/*.py", "jit.py")
FINDINGS = tuple(f"verification/{name}.py" for name in ("finding", "outcomes"))
REPORTING = ("variables.py", "figures/**/*.py", "report/**/*.py", "report/templates/*")
DESCRIBED = read_studies()
PARTS = int(config.get("parts", 0))
STUDIES = asked_studies(config.get("studies"))
PAPER = [*sorted(name for name in DESCRIBED if name.startswith("fig")), "witness", "witness_mesh"]
CHECKS = [study for study in DESCRIBED if has(study, "checks")]
VERIFICATIONS = [study for study in STUDIES if study in CHECKS]
