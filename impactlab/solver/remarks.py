"""What to know of answers that are there: one bit each (in words: impactlab.variables.REMARKS)."""

CONTACT_CREATED_ENERGY = 1
CONTACT_LEFT_A_BULGE = 2
