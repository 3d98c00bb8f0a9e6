# Checks of the solver against independent solutions.

ruleorder: report_checks > report


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
    priority: 1  # beside the reports, for it takes long on one core
    conda:
        "../../environment.yaml"
    shell:
        "impactlab --log {log} verify {input.study} --output {output} --exit-zero"


use rule report as report_checks with:
    input:
        code=code(*FINDINGS, *REPORTING),
        study="studies/{study}.yaml",
        findings="results/{study}/findings.nc",
    output:
        report(
            directory("results/{study}/figures"),
            patterns=["{figure}.svg"],
            caption="../captions/figures.rst",
            category="{study}",
            labels={"item": "{figure}"},
        ),
        report(
            "results/{study}/report.html",
            caption="../captions/report.rst",
            category="{study}",
            labels={"item": "report"},
        ),
    benchmark:
        "results/{study}/benchmarks/report_checks.tsv"
    wildcard_constraints:
        study="|".join(CHECKS) or "(?!)",


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
