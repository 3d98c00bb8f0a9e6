"""Phase velocity of bending waves in each scheme over the exact one: docs/dispersion.png.

python tests/benchmarks/dispersion.py

The formulas are derived in docs/modal.md; the beam is the paper's, the time steps those of
`courant: 0.9`.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from impactlab.solver.semi_implicit import BETA
from matplotlib.figure import Figure

import impactlab as il
from impactlab.figures import style

COURANT, NODES = 0.9, (31, 101, 401)
NAMES = {"modal": "modal", "leapfrog": "leapfrog", "semi_implicit": "semi-implicit"}


def turn(scheme: str, omega_dt: np.ndarray, kdx: np.ndarray) -> np.ndarray:
    """Return the scheme's omega dt of waves whose exact one is omega_dt, k dx = kdx."""
    if scheme == "modal":
        return np.minimum(omega_dt, 0.5 * np.pi)
    differences = omega_dt * np.sinc(0.5 * kdx / np.pi) ** 2
    beta = BETA if scheme == "semi_implicit" else 0.0
    return 2.0 * np.arcsin(0.5 * differences / np.sqrt(1.0 + beta * differences**2))


@style.paper
def drawn() -> Figure:
    """Draw a panel per number of nodes."""
    beam = il.paper_impact().beam
    radius = beam.depth / np.sqrt(12.0)
    wavelength = np.geomspace(2.0, 100.0, 400)
    kdx = 2.0 * np.pi / wavelength
    figure, axes = style.panels(len(NODES), columns=3, height=50, sharey=True)
    for ax, nodes in zip(axes, NODES, strict=True):
        dx = beam.span / (nodes - 1)
        largest = {"leapfrog": 0.5 * kdx**2}
        for at, (scheme, name) in enumerate(NAMES.items()):
            exact = COURANT * largest.get(scheme, 0.5 * radius / dx * kdx**2)
            ratio = turn(scheme, exact, kdx) / exact
            ax.semilogx(wavelength, ratio, color=style.COLOURS[at], ls=style.LINES[at], label=name)
        ax.set_title(f"{nodes} nodes, {1e3 * dx:.1f} mm apart", loc="left")
        ax.set_xticks([2, 5, 10, 20, 50, 100], ["2", "5", "10", "20", "50", "100"])
        ax.minorticks_off()
    axes[0].set_ylim(0.0, 1.05)
    figure.supxlabel("node spacings per wavelength")
    figure.supylabel("phase velocity over exact")
    style.legend(figure)
    return figure


if __name__ == "__main__":
    drawn().savefig(Path(__file__).parents[2] / "docs" / "dispersion.png")
