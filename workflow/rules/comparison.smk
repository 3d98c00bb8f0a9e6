# Studies side by side: what differs between them, and what that changes.

ruleorder: comparison > report


rule comparison:
    input:
        code=code("analysis/differences.py", *REPORTING),
        stored=lambda wildcards: expand(
            "results/{study}/{name}",
            study=COMPARISONS[wildcards.comparison],
            name=["runs.nc", "analysis.nc", "report.html"],
        ),
    output:
        "results/{comparison}/comparison.nc",
        report(
            "results/{comparison}/report.html",
            caption="../captions/comparison.rst",
            category="Comparisons",
            labels={"item": "{comparison}"},
        ),
        report(
            directory("results/{comparison}/figures"),
            patterns=["{figure}.svg"],
            caption="../captions/figures.rst",
            category="Comparisons",
            labels={"item": "{figure}"},
        ),
    wildcard_constraints:
        comparison="|".join(COMPARISONS) or "(?!)",
    log:
        "results/{comparison}/logs/comparison.log",
    benchmark:
        "results/{comparison}/benchmarks/comparison.tsv"
    params:
        studies=lambda wildcards: " ".join(COMPARISONS[wildcards.comparison]),
    threads: 1
    conda:
        "../../environment.yaml"
    shell:
        "impactlab --log {log} compare {params.studies} --output results/{wildcards.comparison}"
