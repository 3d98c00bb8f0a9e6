# studies/NAME.yaml -> design.nc -> runs.nc -> analysis.nc -> figures/ -> report.html, and one index.
# All committed studies: snakemake --cores all. Some: snakemake --cores all --config studies=smoke,sobol
import os
from pathlib import Path


def asked_studies(asked):
    """Names from `--config studies=...`; without it every study but smoke, which is for tests."""
    if not asked:
        return [path.stem for path in sorted(Path("studies").glob("*.yaml")) if path.stem != "smoke"]
    return str(asked).replace(",", " ").split() if not isinstance(asked, list) else asked


def code(*patterns):
    """Sources that a step depends on: when they change, the step is done again."""
    return sorted(str(path) for pattern in patterns for path in Path("impactlab").glob(pattern))


MODEL = ("dataset.py", "model/*.py")
SOLVER = (*MODEL, "simulate.py", "kernels/**/*.py")
STUDIES = asked_studies(config.get("studies"))


report: "workflow/captions/workflow.rst"


wildcard_constraints:
    study="[A-Za-z0-9_-]+",


rule index:
    input:
        code=code("report/**/*.py", "report/templates/*"),
        reports=expand("results/{study}/report.html", study=STUDIES),
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


rule design:
    input:
        code=code(*MODEL, "study/**/*.py"),
        study="studies/{study}.yaml",
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
        code=code(*SOLVER, "study/**/*.py"),
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


rule analysis:
    input:
        code=code("dataset.py", "analysis/**/*.py"),
        runs="results/{study}/runs.nc",
    output:
        "results/{study}/analysis.nc",
    log:
        "results/{study}/logs/analysis.log",
    benchmark:
        "results/{study}/benchmarks/analysis.tsv"
    threads: 1
    conda:
        "environment.yaml"
    shell:
        "impactlab --log {log} analyse {input.runs} --output {output}"


rule figures:
    input:
        code=code("dataset.py", "figures/**/*.py"),
        runs="results/{study}/runs.nc",
        analysis="results/{study}/analysis.nc",
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
        "impactlab --log {log} figures {input.runs} {input.analysis} --output {output}"


rule report:
    input:
        code=code("dataset.py", "report/**/*.py", "report/templates/*"),
        runs="results/{study}/runs.nc",
        analysis="results/{study}/analysis.nc",
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
        "impactlab --log {log} report {input.runs} {input.analysis} --figures {input.figures}"
        " --output {output}"
