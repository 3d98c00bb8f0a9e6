# studies/NAME.yaml -> design.nc -> runs.nc -> analysis.nc -> figures/ -> report.html, and one index.
# A study of checks: studies/NAME.yaml -> findings.nc -> figures/ -> report.html, then the verdict.
# Those of the paper's figures, fig*.yaml, and of its 3-D witness also -> results/paper: figures, claims.
# Only these: snakemake --cores all paper
# All committed studies: snakemake --cores all. Some: snakemake --cores all --config studies=smoke,sobol
import os
import re
from pathlib import Path


def asked_studies(asked):
    """Names from `--config studies=...`; without it every study but smoke, which is for tests."""
    if not asked:
        return [path.stem for path in sorted(Path("studies").glob("*.yaml")) if path.stem != "smoke"]
    return str(asked).replace(",", " ").split() if not isinstance(asked, list) else asked


def has_key(study, pattern):
    """Whether a study has a key; what is wrong with a file is told by the command that reads it."""
    file = Path(f"studies/{study}.yaml")
    return file.exists() and bool(re.search(pattern, file.read_text("utf-8", "replace"), re.MULTILINE))


def lists_checks(study):
    """Whether it is a verification."""
    return has_key(study, r"^checks\s*:")


def is_auto(study):
    """Whether its discretisation is to be found."""
    return has_key(study, r"\bauto\b")


def is_sample(study):
    """Whether its runs are impacts drawn at random: sensitivity has a numerical uncertainty."""
    return has_key(study, r"\bmethod\s*:\s*(?!grid)\w") and not has_key(study, r"^function\s*:")


def is_refined(study):
    """Whether its numerical uncertainty is measured: a Sobol sample of impacts."""
    return is_sample(study) and has_key(study, r"\bmethod\s*:\s*sobol\b")


def resolution(wildcards, needed):
    """What was found out about discretisations, where it is needed."""
    return [f"results/{wildcards.study}/resolution.nc"] if needed(wildcards.study) else []


def refinement(wildcards):
    """The first runs on finer grids, where there are any."""
    return [f"results/{wildcards.study}/refinement.nc"] if is_refined(wildcards.study) else []


def evidence(wildcards, input):
    """What is known of the numerical uncertainty, as options."""
    known = {"resolution": input.resolution, "refinement": input.refinement}
    return " ".join(f"--{name} {file}" for name, file in known.items() if file)


def is_solid(study):
    """Whether some of its runs are of the 3-D model."""
    return has_key(study, r"\bsolid\b")


def solving(wildcards):
    """Sources of the runs; the analysis is one where it decides how many there are."""
    deciding = ("analysis/**/*.py",) if has_key(wildcards.study, r"\buntil\s*:") else ()
    solid = ("fem3d/**/*.py",) if is_solid(wildcards.study) else ()
    return code(*SOLVER, "study/**/*.py", *deciding, *solid)


def stored(wildcards):
    """What figures and report are made from."""
    names = ["findings.nc"] if lists_checks(wildcards.study) else ["runs.nc", "analysis.nc"]
    return [f"results/{wildcards.study}/{name}" for name in names]


def answers():
    """The page on the paper, where all studies that it takes are asked for."""
    return ["results/paper/claims.html"] if PAPER and set(PAPER) <= set(STUDIES) else []


def code(*patterns):
    """Sources that a step depends on: when they change, the step is done again."""
    return sorted(str(path) for pattern in patterns for path in Path("impactlab").glob(pattern))


MODEL = ("variables.py", "model/*.py")
SOLVER = (*MODEL, "simulate.py", "solver/**/*.py", "jit/*.py")
CHECKING = ("study/checking.py", "study/declaration/**/*.py", "study/storage.py")
FINDINGS = tuple(f"verification/{name}.py" for name in ("finding", "stored"))
REPORTING = ("report/**/*.py", "report/templates/*")
STUDIES = asked_studies(config.get("studies"))
PAPER = [*(path.stem for path in sorted(Path("studies").glob("fig*.yaml"))), "witness", "witness_mesh"]
VERIFICATIONS = [study for study in STUDIES if lists_checks(study)]


report: "workflow/captions/workflow.rst"


wildcard_constraints:
    study="[A-Za-z0-9_-]+",


rule all:
    input:
        "results/index.html",
        expand("results/{study}/passed", study=VERIFICATIONS),


rule index:
    input:
        code=code(*REPORTING),
        reports=expand("results/{study}/report.html", study=STUDIES),
        paper=answers(),
    output:
        report("results/index.html", caption="workflow/captions/index.rst", category="Index"),
    log:
        "results/index.log",
    benchmark:
        "results/index.benchmark.tsv"
    threads: 1
    conda:
        "environment.yaml"
    shell:
        "impactlab --log {log} index results --output {output}"


rule resolution:
    input:
        code=code(*SOLVER, "study/**/*.py", "analysis/convergence/*.py"),
        study="studies/{study}.yaml",
    output:
        "results/{study}/resolution.nc",
    log:
        "results/{study}/logs/resolution.log",
    benchmark:
        "results/{study}/benchmarks/resolution.tsv"
    threads: os.cpu_count()  # scaled down to --cores
    conda:
        "environment.yaml"
    shell:
        "impactlab --log {log} recommend {input.study} --output {output} --workers {threads}"


# An auto discretisation is read from the resolution, which lies beside the output.
rule design:
    input:
        code=code(*MODEL, "study/**/*.py"),
        study="studies/{study}.yaml",
        resolution=lambda wildcards: resolution(wildcards, is_auto),
    output:
        "results/{study}/design.nc",
    log:
        "results/{study}/logs/design.log",
    benchmark:
        "results/{study}/benchmarks/design.tsv"
    threads: 1
    conda:
        "environment.yaml"
    shell:
        "impactlab --log {log} design {input.study} --output {output}"


# Its shards live beside the output, not as one: Snakemake would remove them when a job fails.
rule runs:
    input:
        code=solving,
        design="results/{study}/design.nc",
    output:
        "results/{study}/runs.nc",
    log:
        "results/{study}/logs/runs.log",
    benchmark:
        "results/{study}/benchmarks/runs.tsv"
    threads: os.cpu_count()  # scaled down to --cores
    conda:
        "environment.yaml"
    shell:
        "impactlab --log {log} run {input.design} --output {output} --workers {threads}"


rule refinement:
    input:
        code=code(*SOLVER, "study/**/*.py"),
        runs="results/{study}/runs.nc",
    output:
        "results/{study}/refinement.nc",
    log:
        "results/{study}/logs/refinement.log",
    benchmark:
        "results/{study}/benchmarks/refinement.tsv"
    threads: os.cpu_count()  # scaled down to --cores
    conda:
        "environment.yaml"
    shell:
        "impactlab --log {log} refine {input.runs} --output {output} --workers {threads}"


# Of a sample indices.csv, indices.nc and surrogate.nc come with it: no outputs, for a grid has none.
rule analysis:
    input:
        code=code(*MODEL, "analysis/**/*.py"),
        runs="results/{study}/runs.nc",
        resolution=lambda wildcards: resolution(wildcards, is_sample),
        refinement=refinement,
    output:
        "results/{study}/analysis.nc",
    log:
        "results/{study}/logs/analysis.log",
    benchmark:
        "results/{study}/benchmarks/analysis.tsv"
    params:
        evidence=evidence,
    threads: 1
    conda:
        "environment.yaml"
    shell:
        "impactlab --log {log} analyse {input.runs} {params.evidence} --output {output}"


# Checks that fail are findings like others: the report comes first, the verdict last.
rule verify:
    input:
        code=code(*SOLVER, "verification/**/*.py", *CHECKING),
        study="studies/{study}.yaml",
    output:
        "results/{study}/findings.nc",
    log:
        "results/{study}/logs/verify.log",
    benchmark:
        "results/{study}/benchmarks/verify.tsv"
    threads: 1
    conda:
        "environment.yaml"
    shell:
        "impactlab --log {log} verify {input.study} --output {output} --exit-zero"


rule figures:
    input:
        code=code("variables.py", *FINDINGS, "figures/**/*.py"),
        stored=stored,
    output:
        report(
            directory("results/{study}/figures"),
            patterns=["{figure}.svg"],
            caption="workflow/captions/figures.rst",
            category="{study}",
            labels={"item": "{figure}"},
        ),
    log:
        "results/{study}/logs/figures.log",
    benchmark:
        "results/{study}/benchmarks/figures.tsv"
    threads: 1
    conda:
        "environment.yaml"
    shell:
        "impactlab --log {log} figures {input.stored} --output {output}"


rule report:
    input:
        code=code("variables.py", *FINDINGS, *REPORTING),
        stored=stored,
        figures="results/{study}/figures",
    output:
        report(
            "results/{study}/report.html",
            caption="workflow/captions/report.rst",
            category="{study}",
            labels={"item": "report"},
        ),
    log:
        "results/{study}/logs/report.log",
    benchmark:
        "results/{study}/benchmarks/report.tsv"
    threads: 1
    conda:
        "environment.yaml"
    shell:
        "impactlab --log {log} report {input.stored} --figures {input.figures} --output {output}"


rule paper:
    input:
        code=code("variables.py", "paper/**/*.py", "figures/**/*.py", "verification/solutions/*.py", *REPORTING),
        stored=expand("results/{study}/{name}", study=PAPER, name=["runs.nc", "analysis.nc"]),
    output:
        "results/paper/claims.csv",
        "results/paper/numbers.csv",
        report("results/paper/claims.html", caption="workflow/captions/claims.rst", category="Paper"),
        report(
            directory("results/paper/figures"),
            patterns=["{figure}.svg"],
            caption="workflow/captions/figures.rst",
            category="Paper",
            labels={"item": "{figure}"},
        ),
    log:
        "results/paper/logs/paper.log",
    benchmark:
        "results/paper/benchmarks/paper.tsv"
    params:
        folders=expand("results/{study}", study=PAPER),
    threads: 1
    conda:
        "environment.yaml"
    shell:
        "impactlab --log {log} paper {params.folders} --output results/paper"


# After everything else, so that a failure hides no report.
rule verdict:
    input:
        code=code(*FINDINGS),
        findings="results/{study}/findings.nc",
        index="results/index.html",
    output:
        touch("results/{study}/passed"),
    log:
        "results/{study}/logs/verdict.log",
    benchmark:
        "results/{study}/benchmarks/verdict.tsv"
    threads: 1
    conda:
        "environment.yaml"
    shell:
        "impactlab --log {log} verify {input.findings}"
