"""Look-ups of the tests in a drawn figure."""

import re
from collections import Counter

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text

from impactlab.figures import style

_KEY = re.compile(r"[a-z0-9]_[a-z0-9]|\w-\d\)|\bus\b")
"""A name of a program, or a unit as computers write it: kogut_etsion, (s-1), us."""


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


def assert_texts_are_fit_for_print(figure: Figure) -> None:
    """Assert that a figure fits a page, and that its texts are legible, in words, and said once."""
    assert figure.get_figheight() <= style.PAGE * style.MILLIMETRE + 1e-9
    shown = [text for text in figure.findobj(Text) if text.get_visible() and text.get_text()]
    for text in shown:
        assert text.get_fontsize() >= 6, text
        assert not _KEY.search(text.get_text()), text
    panels = [axes.get_legend() for axes in figure.axes if axes.get_legend()]
    legends = [text.get_text() for key in (*figure.legends, *panels) for text in key.get_texts()]
    repeated = [label for label, count in Counter(legends).items() if count > 1]
    assert repeated == []
