"""Error of the phase velocity of bending waves in each scheme: docs/dispersion.png.

python tests/benchmarks/dispersion.py

The formulas are derived in docs/modal.md; the beam is the paper's, the time steps those of
`courant: 0.9`.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import impactlab as il
from impactlab.figures import style

COURANT, NODES = 0.9, (31, 101, 401)


@style.paper
def drawn() -> Figure:
    """Draw a panel per number of nodes."""
    beam = il.paper_impact().beam
    radius = beam.depth / np.sqrt(12.0)
    wavelength = np.geomspace(2.0, 100.0, 2000)
    kdx = 2.0 * np.pi / wavelength
    figure, axes = style.panels(len(NODES), columns=3, height=50, sharey=True)
    for ax, nodes in zip(axes, NODES, strict=True):
        dx = beam.span / (nodes - 1)
        exact = COURANT * radius / dx * kdx**2
        modal = np.minimum(exact, 0.5 * np.pi) / exact
        exact = COURANT * 0.5 * kdx**2
        leapfrog = 2.0 * np.arcsin(0.5 * exact * np.sinc(0.5 * kdx / np.pi) ** 2) / exact
        for at, (name, ratio) in enumerate({"modal": modal, "leapfrog": leapfrog}.items()):
            error = np.maximum(100.0 * (1.0 - ratio), 1e-9)
            ax.loglog(wavelength, error, color=style.COLOURS[at], ls=style.LINES[at], label=name)
        ax.set_title(f"{nodes} nodes, {1e3 * dx:.1f} mm apart", loc="left")
        ax.set_xticks([2, 5, 10, 20, 50, 100], ["2", "5", "10", "20", "50", "100"])
        ax.minorticks_off()
    axes[0].text(3.4, 0.025, "modal: exact")
    axes[0].set_ylim(0.01, 100.0)
    figure.supxlabel("node spacings per wavelength")
    figure.supylabel("lag of the phase velocity, %")
    style.legend(figure)
    return figure


if __name__ == "__main__":
    drawn().savefig(Path(__file__).parents[2] / "docs" / "dispersion.png")
