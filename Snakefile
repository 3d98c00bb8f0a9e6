# studies/NAME.yaml -> design.nc, runs.nc -> analysis.nc, figures/, report.html, and one index.
# A study of checks: studies/NAME.yaml -> findings.nc -> figures/, report.html, then the verdict.
# Every study: snakemake --cores all. Some: snakemake --cores all --config studies=smoke,sobol
# The source paper's figures and statements: snakemake --cores all paper


include: "workflow/rules/common.smk"


report: "workflow/captions/workflow.rst"


wildcard_constraints:
    study="[A-Za-z0-9_-]+",
    part="[0-9]+",
    total="[0-9]+",


# Studies side by side, in this order; each comparison is made where all of its studies are.
COMPARISONS = {"sobol_velocities": ["sobol_slow", "sobol", "sobol_fast"]}


rule all:
    input:
        "results/index.html",
        expand("results/{study}/passed", study=VERIFICATIONS),


include: "workflow/rules/parts.smk"
include: "workflow/rules/runs.smk"
include: "workflow/rules/analysis.smk"
include: "workflow/rules/verification.smk"
include: "workflow/rules/paper.smk"
include: "workflow/rules/comparison.smk"


rule index:
    input:
        code=code(*REPORTING),
        reports=expand("results/{study}/report.html", study=STUDIES),
        comparisons=expand("results/{comparison}/report.html", comparison=comparable(COMPARISONS)),
        paper="results/paper/claims.html" if set(PAPER) <= set(STUDIES) else [],
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
