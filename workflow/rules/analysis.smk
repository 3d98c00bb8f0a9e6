# From solved runs, or the findings of checks, to figures and report.


# Of a sample indices.csv, indices.nc, distribution.csv and surrogate.nc come with it: no outputs, for a grid has none.
rule analysis:
    input:
        code=code(*MODEL, "analysis/**/*.py", "fem3d/study_rules.py"),
        runs="results/{study}/runs.nc",
        resolution=where("resolution.nc", "sample", "auto"),
        refinement=where("refinement.nc", "sobol"),
        measurements=lambda wildcards: DESCRIBED.get(wildcards.study, {}).get("measurements", []),
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
        "../../environment.yaml"
    shell:
        "impactlab --log {log} analyse {input.runs} {params.evidence} --output {output}"


rule figures:
    input:
        code=code("variables.py", *FINDINGS, "figures/**/*.py"),
        stored=stored,
    output:
        report(
            directory("results/{study}/figures"),
            patterns=["{figure}.svg"],
            caption="../captions/figures.rst",
            category="{study}",
            labels={"item": "{figure}"},
        ),
    log:
        "results/{study}/logs/figures.log",
    benchmark:
        "results/{study}/benchmarks/figures.tsv"
    threads: 1
    conda:
        "../../environment.yaml"
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
        "impactlab --log {log} report {input.stored} --figures {input.figures} --output {output}"
