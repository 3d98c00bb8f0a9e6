"""HTML reports from stored datasets and figures: `report` writes one a study, `index` lists them.

One section of the report a file; the pages themselves are in templates/.
"""
