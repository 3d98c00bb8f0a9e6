import numpy as np

from impactlab.figures import data, style
from impactlab.figures.data import name_places


def test_bars_are_kept_once_with_their_errors_and_the_names_of_their_places():
    figure, (ax,) = style.panels(1, columns=1, height=50)
    for offset, label in ((-0.25, "first"), (0.25, "total")):
        ax.barh(np.arange(2) + offset, [0.5, -0.25], 0.4, xerr=[0.125, 0.25], label=label)
    name_places(ax, "y", ["depth", "width"])
    first, total = data.drawn(figure)
    assert (first.curve, total.curve) == ("first", "total")
    for bars in (first, total):
        assert bars.category == ["depth", "width"]
        assert bars.x.tolist() == [0.5, -0.25]
        assert bars.low.tolist() == [0.375, -0.5]
        assert bars.high.tolist() == [0.625, 0.0]
    assert total.y.tolist() == [0.25, 1.25]


def test_points_keep_uneven_errors_along_the_axis_they_were_given_for():
    figure, (ax,) = style.panels(1, columns=1, height=50)
    ax.errorbar([1.0, 2.0], [5.0, 7.0], yerr=[[1.0, 2.0], [3.0, np.nan]], label="up")
    ax.errorbar(3.0, 4.0, xerr=0.5, label="across")
    up, across = data.drawn(figure)
    np.testing.assert_array_equal(up.low, [4.0, 5.0])
    np.testing.assert_array_equal(up.high, [8.0, np.nan])
    assert (across.x.tolist(), across.low.tolist(), across.high.tolist()) == ([3.0], [2.5], [3.5])
    # bars upwards keep their errors too
    figure, (ax,) = style.panels(1, columns=1, height=50)
    ax.bar([1.0, 2.0], [0.5, 0.75], yerr=0.25, label="share")
    (bars,) = data.drawn(figure)
    assert (bars.low.tolist(), bars.high.tolist()) == ([0.25, 0.5], [0.75, 1.0])


def test_readers_may_draw_anything_in_a_panel():
    _, (ax,) = style.panels(1, columns=1, height=50)
    assert len(ax.plot([1.0, 2.0], label="values alone")) == 1
    assert len(ax.bar(["a", "b"], [1.0, 2.0])) == 2
