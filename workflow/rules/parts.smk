# With --config parts=40: a study's runs in as many jobs, which need no scheduler of dask.


# Its blocks lie beside the output, not as one: Snakemake would remove them when a job fails.
rule part:
    input:
        code=solving,
        study="studies/{study}.yaml",
        resolution=where("resolution.nc", "auto"),
    output:
        touch("results/{study}/parts/{part}-of-{total}"),
    log:
        "results/{study}/logs/part-{part}-of-{total}.log",
    benchmark:
        "results/{study}/benchmarks/part-{part}-of-{total}.tsv"
    threads: 4
    conda:
        "../../environment.yaml"
    shell:
        "impactlab --log {log} run {input.study} --part {wildcards.part}/{wildcards.total} "
        "--workers {threads}"
