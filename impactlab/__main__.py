"""`python -m impactlab` is the command `impactlab`."""

from impactlab.cli import main

main()
