# What the rules share: what the program says of the studies, and the sources of each step.
import json
import os
import subprocess
from pathlib import Path


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
    return str(asked).replace(",", " ").split() if not isinstance(asked, list) else asked


def has(study, trait):
    """Return whether the program ascribes this trait to a study."""
    return trait in DESCRIBED.get(study, {}).get("traits", ())


def code(*patterns):
    """Return the sources that a step depends on: when they change, the step is done again."""
    return sorted(str(path) for pattern in patterns for path in Path("impactlab").glob(pattern))


def where(trait, name):
    """Return an input function: the file `name` of a study that has the trait, else nothing."""
    return lambda wildcards: [f"results/{wildcards.study}/{name}"] * has(wildcards.study, trait)


def stored(wildcards):
    """Return what figures and report are made from."""
    names = ["findings.nc"] if has(wildcards.study, "checks") else ["runs.nc", "analysis.nc"]
    return [f"results/{wildcards.study}/{name}" for name in names]


def solving(wildcards):
    """Return the sources of the runs; the analysis is one where it decides how many there are."""
    deciding = ["analysis/**/*.py"] * has(wildcards.study, "growing")
    solid = ["fem3d/**/*.py"] * has(wildcards.study, "fem3d")
    return code(*SOLVER, "study/**/*.py", *deciding, *solid)


def evidence(wildcards, input):
    """Return what is known of the numerical uncertainty, as options."""
    known = {"resolution": input.resolution, "refinement": input.refinement}
    return " ".join(f"--{name} {file}" for name, file in known.items() if file)


MODEL = ("variables.py", "model/*.py")
SOLVER = (*MODEL, "simulate.py", "solver/**/*.py", "jit.py")
FINDINGS = tuple(f"verification/{name}.py" for name in ("finding", "stored"))
REPORTING = ("report/**/*.py", "report/templates/*")
DESCRIBED = read_studies()
STUDIES = asked_studies(config.get("studies"))
PAPER = [*sorted(name for name in DESCRIBED if name.startswith("fig")), "witness", "witness_mesh"]
VERIFICATIONS = [study for study in STUDIES if has(study, "checks")]
