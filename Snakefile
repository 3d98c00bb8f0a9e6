# studies/NAME.yaml -> design.nc -> runs.nc -> analysis.nc -> figures/ -> report.html, and one index.
# A study of checks: studies/NAME.yaml -> findings.nc -> figures/ -> report.html, then the verdict.
# Every study: snakemake --cores all. Some: snakemake --cores all --config studies=smoke,sobol
# The source paper's figures and statements: snakemake --cores all paper


include: "workflow/rules/common.smk"


report: "workflow/captions/workflow.rst"


wildcard_constraints:
    study="[A-Za-z0-9_-]+",


rule all:
    input:
        "results/index.html",
        expand("results/{study}/passed", study=VERIFICATIONS),


include: "workflow/rules/runs.smk"
include: "workflow/rules/analysis.smk"
include: "workflow/rules/verification.smk"
include: "workflow/rules/paper.smk"


rule index:
    input:
        code=code(*REPORTING),
        reports=expand("results/{study}/report.html", study=STUDIES),
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
