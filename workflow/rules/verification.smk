# Checks of the solver against independent solutions.


# Checks that fail are findings like others: the report comes first, the verdict last.
rule verify:
    input:
        code=code(*SOLVER, "verification/**/*.py", "study/**/*.py"),
        study="studies/{study}.yaml",
    output:
        "results/{study}/findings.nc",
    log:
        "results/{study}/logs/verify.log",
    benchmark:
        "results/{study}/benchmarks/verify.tsv"
    threads: 1
    conda:
        "../../environment.yaml"
    shell:
        "impactlab --log {log} verify {input.study} --output {output} --exit-zero"


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
        "../../environment.yaml"
    shell:
        "impactlab --log {log} verify {input.findings}"
