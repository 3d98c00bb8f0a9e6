"""What to know of a run's answers, one bit each (in words: impactlab.variables.STATUS_FLAGS).

All but the last say why an answer is missing; the last leaves every answer, and marks them.
"""

DIVERGED = 1
FIRST_CONTACT_UNFINISHED = 2
IN_CONTACT_AT_END = 4
SPHERE_NOT_LEAVING = 8
DEFLECTION_STILL_GROWING = 16
INDENTATION_STILL_GROWING = 32
ENERGY_OUT_OF_BALANCE = 64
OUTSIDE_CONTACT_LAW = 128
