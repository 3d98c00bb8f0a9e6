# From solved runs to analysis, figures and report, in one process.


# Of a sample indices.csv, indices.nc, distribution.csv and surrogate.nc come with it: no outputs, for a grid has none.
rule report:
    input:
        code=code(*MODEL, "analysis/**/*.py", "fem3d/study_rules.py", *REPORTING),
        study="studies/{study}.yaml",
        runs="results/{study}/runs.nc",
        measurements=lambda wildcards: DESCRIBED.get(wildcards.study, {}).get("measurements", []),
    output:
        "results/{study}/analysis.nc",
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
    log:
        "results/{study}/logs/report.log",
    benchmark:
        "results/{study}/benchmarks/report.tsv"
    threads: 1
    conda:
        "../../environment.yaml"
    shell:
        "impactlab --log {log} go {input.study} --only report"
