"""Cumulative distributions, and parameters in runs above a limit."""

import numpy as np
import pytest
import samples
from drawings import panel, words

from impactlab.analysis import distribution
from impactlab.figures import data
from impactlab.figures.catalogue import CATALOGUE, applicable

LIMIT = 35e3


@pytest.fixture
def study():
    """A Latin hypercube of 400 runs with a limit, of which the fastest 40 failed."""
    runs = samples.sample(400, 4, failures=40)[["peak_force", "status"]]
    limit = {"limited": "peak_force", "limits": LIMIT}
    runs = runs.assign_attrs(method="delta", responses="peak_force", **limit)
    return runs, distribution.analysis(runs)


def test_the_curve_is_that_of_the_draws_within_its_band(study):
    runs, _ = study
    curve = next(data.drawn(CATALOGUE["cumulative_distributions"].plot(*study)))
    force = 1e-3 * runs["peak_force"].values
    share = [(force <= x).sum() / 360 for x in curve.x]
    np.testing.assert_allclose(curve.y, share)
    axes = panel(CATALOGUE["cumulative_distributions"].plot(*study), "Peak force")
    (limit,) = (line for line in axes.lines if line.get_label() == "_guide: limit")
    assert np.asarray(limit.get_xdata()).tolist() == [35.0, 35.0]
    low, high = np.asarray(axes.collections[0].get_paths()[0].vertices)[:, 1][[1, -2]]
    # sqrt(log(2 / 0.05) / 800), and the 40 missing runs above
    assert sorted([low, high])[1] == pytest.approx(1 / 400 + 0.0679 + 0.1, abs=1e-3)
    caption = CATALOGUE["cumulative_distributions"].caption(*study)
    assert "95 % band of Dvoretzky" in caption
    assert "40 of 400 runs are missing here" in caption


def test_each_parameter_above_the_limit_beside_the_others(study):
    runs, analysis = study
    record = applicable(runs, analysis)["exceedance_peak_force"]
    figure = record.plot(runs, analysis)
    above, others, *_ = data.drawn(figure)
    force, velocity = runs["peak_force"].values, runs["velocity"].values
    np.testing.assert_allclose(above.x, np.sort(velocity[force > LIMIT]))
    assert others.x.max() == velocity[force <= LIMIT].max()
    alphas = [ax.lines[0].get_alpha() for ax in figure.axes]
    assert alphas[0] is None
    assert alphas[-1] == 0.4
    distance = analysis["exceedance_distance"].sel(varied_parameter="velocity").item()
    assert words(figure.axes[0])[0].startswith(f"D = {distance:.2f}\np < 0.001")
    counts = (force > LIMIT).sum(), (force <= LIMIT).sum()
    assert "in the {} draws with a peak force above 35 kN, and in the other {}.".format(
        *counts
    ) in record.caption(runs, analysis)
    # without a draw on either side there is no figure
    runs, _ = study
    runs = runs.assign_attrs(limits=1e6)
    assert "exceedance_peak_force" not in applicable(runs, distribution.analysis(runs))


def test_words_have_shares(study):
    runs, _ = study
    words = np.where(runs["peak_force"] > LIMIT, "mjg", "hertz").astype("U7")
    words[:40] = "stronge"
    given = {"distribution": "choice", "values": ["stronge", "mjg", "hertz"]}
    runs = runs.drop_vars("contact").assign_coords(contact=("run", words, given))
    runs.attrs["varied"] = ["velocity", "contact"]
    analysis = distribution.analysis(runs)
    figure = applicable(runs, analysis)["exceedance_peak_force"].plot(runs, analysis)
    above, others = list(data.drawn(figure))[2:]
    drawn = runs["peak_force"].values > LIMIT
    expected = [(words[drawn] == word).mean() for word in ("stronge", "mjg")]
    np.testing.assert_allclose(above.y, expected)
    assert others.x.tolist() == [0.0, 2.0]
    assert [text.get_text() for text in figure.axes[1].get_xticklabels()][2] == "Hertz"
