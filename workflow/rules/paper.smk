# The source paper: its figures drawn anew, its statements judged.


rule paper:
    input:
        code=code(
            "paper/**/*.py",
            "paper/templates/*",
            "verification/solutions/*.py",
            *REPORTING,
        ),
        stored=expand("results/{study}/{name}", study=PAPER, name=["runs.nc", "analysis.nc"]),
    output:
        "results/paper/claims.csv",
        "results/paper/numbers.csv",
        report("results/paper/claims.html", caption="../captions/claims.rst", category="Paper"),
        report(
            directory("results/paper/figures"),
            patterns=["{figure}.svg"],
            caption="../captions/figures.rst",
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
        "../../environment.yaml"
    shell:
        "impactlab --log {log} paper {params.folders} --output results/paper"
