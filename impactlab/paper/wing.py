"""Additions of this wing to the core."""

from impactlab.wings import Wing

WING = Wing(commands={"paper": "impactlab.paper.command:paper"})
