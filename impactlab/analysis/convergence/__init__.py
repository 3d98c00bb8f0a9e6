"""Convergence along each axis of the discretisation: nodes, time step, integration points."""
