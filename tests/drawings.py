"""Look-ups of the tests in a drawn figure."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D


def panel(figure: Figure, title: str) -> Axes:
    """The panel whose title starts so."""
    return next(axes for axes in figure.axes if axes.get_title(loc="left").startswith(title))


def points(line: Line2D) -> tuple[np.ndarray, np.ndarray]:
    """The x and y of a line."""
    return np.asarray(line.get_xdata(), dtype=float), np.asarray(line.get_ydata(), dtype=float)


def curve(axes: Axes, label: str) -> tuple[np.ndarray, np.ndarray]:
    """The x and y of the first line with this label."""
    return points(next(line for line in axes.lines if line.get_label() == label))


def is_guide(line: Line2D) -> bool:
    """Return whether a line is a guide and no data."""
    return str(line.get_label()).startswith("_guide")


def words(axes: Axes) -> list[str]:
    """Return what is written in the panel."""
    return [text.get_text() for text in axes.texts]
