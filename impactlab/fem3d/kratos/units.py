"""Kratos knows no units; its tolerances suit mm, t, s, and with them N and MPa."""

MM = 1e3
"""mm in a m, mm/s in a m/s."""
MPA = 1e-6
"""MPa in a Pa."""
TONNES_PER_MM3 = 1e-12
"""t/mm3 in a kg/m3."""
N_PER_MM3 = 1e-9
"""N/mm3 in a N/m3."""
