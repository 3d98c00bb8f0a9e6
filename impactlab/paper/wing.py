"""What this wing adds to the core."""

from impactlab.wings import Wing

WING = Wing(commands={"paper": "impactlab.paper.command:paper"})
