"""Look-ups of the tests in a drawn figure."""

import re
from collections import Counter
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
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


def laid_out(figure: Figure) -> Figure:
    """Lay a figure out in the style of the reports, and return it."""
    FigureCanvasAgg(figure)
    with style.applied():
        figure.draw_without_rendering()
    return figure


def assert_text_is_apart(figure: Figure) -> None:
    """Assert that no label of a tick overlaps another."""
    for axes in figure.axes:
        for ticks in (axes.get_xticklabels(which="both"), axes.get_yticklabels(which="both")):
            shown = [label for label in ticks if label.get_text() and _inside(axes, label)]
            boxes = sorted(
                (label.get_window_extent() for label in shown), key=lambda b: (b.x0, b.y0)
            )
            assert all(not left.overlaps(right) for left, right in pairwise(boxes))


def assert_panels_and_legends_are_on_the_page_and_apart(figure: Figure) -> None:
    """Assert that panels and legends neither overlap nor leave the page."""
    page, boxes = figure.bbox, [axes.get_tightbbox() for axes in figure.axes]
    shared = [label.get_window_extent() for label in figure.texts]
    for at, box in enumerate(boxes):
        assert box is not None
        assert box.x0 >= page.x0 - 1
        assert box.x1 <= page.x1 + 1
        assert box.y1 <= page.y1 + 1
        assert not any(box.padded(-1).overlaps(other.padded(-1)) for other in boxes[at + 1 :])
        for legend in figure.legends:
            assert legend.get_window_extent().x0 >= page.x0 - 1
            assert legend.get_window_extent().x1 <= page.x1 + 1
            for other in (box, *shared):
                assert not legend.get_window_extent().overlaps(other)


def _inside(axes, label):
    box = axes.get_window_extent().padded(1)
    x, y = label.get_window_extent().get_points().mean(axis=0)
    return bool(box.x0 <= x <= box.x1 or box.y0 <= y <= box.y1) and label.get_visible()
