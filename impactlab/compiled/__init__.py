"""How numbers are made fast: functions compiled by numba and kept on disk."""
