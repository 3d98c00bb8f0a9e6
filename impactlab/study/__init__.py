"""Studies: what a YAML file asks for, drawn up as runs, solved under dask, kept as netCDF."""
