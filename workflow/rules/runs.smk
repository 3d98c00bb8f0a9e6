# From a study file to its solved runs, in one process: programs take longer to load than most steps take.


# Pilot runs, design and refinement come with them (resolution.nc, design.nc, refinement.nc, multifidelity.nc), and shards,
# which are no outputs: Snakemake would remove them when a job fails.
rule runs:
    input:
        code=solving,
        study="studies/{study}.yaml",
        table=lambda wildcards: DESCRIBED.get(wildcards.study, {}).get("table", []),
        parts=parts,  # which it takes over
    output:
        "results/{study}/runs.nc",
    log:
        "results/{study}/logs/runs.log",
    benchmark:
        "results/{study}/benchmarks/runs.tsv"
    threads: os.cpu_count()  # scaled down to --cores
    priority: 2  # with all cores, before what takes one
    conda:
        "../../environment.yaml"
    shell:
        "impactlab --log {log} go {input.study} --only solve --workers {threads}"


# For those who ask for its file alone, as the two below.
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
        "../../environment.yaml"
    shell:
        "impactlab --log {log} recommend {input.study} --output {output} --workers {threads}"


# An auto discretisation is read from the resolution, which lies beside the output.
rule design:
    input:
        code=code(*MODEL, "study/**/*.py"),
        study="studies/{study}.yaml",
        resolution=where("resolution.nc", "auto"),
    output:
        "results/{study}/design.nc",
    log:
        "results/{study}/logs/design.log",
    benchmark:
        "results/{study}/benchmarks/design.tsv"
    threads: 1
    conda:
        "../../environment.yaml"
    shell:
        "impactlab --log {log} design {input.study} --output {output}"


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
        "../../environment.yaml"
    shell:
        "impactlab --log {log} refine {input.runs} --output {output} --workers {threads}"
