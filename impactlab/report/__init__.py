"""HTML reports from stored datasets and figures, and the tables that the command line prints.

A report (`study`, `verification`) consists of sections, one concept per file; `results` knows the
kinds of stored results and writes the index of all reports. The pages are in templates/.
"""
