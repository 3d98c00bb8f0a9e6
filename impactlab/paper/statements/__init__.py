"""What the paper says, put to the test on solved studies: one statement a file.

`catalogue` has the table; `claim` the words that all share; `evidence` how numbers are taken.
"""
