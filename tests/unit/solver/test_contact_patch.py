"""The shares of the load on nodes and modes, and the radius of every contact law."""

import numpy as np
import pytest
from scipy.integrate import quad

import impactlab as il
from impactlab.model.case_table import case_table
from impactlab.solver.contact import LAWS
from impactlab.solver.contact.history import CONTACT, Pair, load
from impactlab.solver.contact.switch import limit, radius
from impactlab.solver.contact_patch import contact_radius, node_share, wave_share

STEEL = (115e9, 0.035, 345e6, 0.3)


@pytest.mark.parametrize("a", [0.01, 0.4, 0.99, 1.0, 1.7, 12.3])
def test_the_moments_of_a_beam_at_rest_are_exact_at_the_nodes(a):
    """Sum F and mean distance 3 a/8, so F L/4 - 3 F a/16 at mid-span, however coarse the nodes."""
    dx = 1.0
    shares = np.array([node_share(k, dx, a) for k in range(20)])
    assert shares[0] + 2.0 * shares[1:].sum() == pytest.approx(1.0, rel=1e-13)
    assert 2.0 * shares[1:] @ np.arange(1, 20) == pytest.approx(3.0 * a / 8.0, rel=1e-12)
    assert np.all(shares >= -1e-15)

    def load_on(x, k):
        return 0.75 / a * (1.0 - (x / a) ** 2) * max(1.0 - abs(x - k), 0.0)

    for k in (0, 1, 5):
        low, high = max(k - 1.0, -a), min(k + 1.0, a)
        expected = sum(quad(load_on, *ends, args=(k,))[0] for ends in ((low, k), (k, high)))
        if low < k < high:
            assert shares[k] == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("z", [0.0, 1e-6, 0.05, 0.0999, 0.1001, 2.0, 30.0])
def test_the_share_of_a_mode_is_the_transform_of_the_load(z):
    expected, _ = quad(lambda s: 1.5 * (1.0 - s * s) * np.cos(z * s), 0.0, 1.0)
    assert wave_share(z) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("law", LAWS)
def test_the_circle_is_that_of_hertz_until_first_yield_and_wider_beyond(law):
    E, R, S_y, _ = STEEL
    number, deepest = LAWS.index(law), limit(LAWS.index(law), *STEEL)
    early = np.geomspace(1e-9, 0.9, 5) * (0.5 * np.pi * 1.6 * S_y / E) ** 2 * R
    assert [radius(number, d, *STEEL) for d in early] == pytest.approx(np.sqrt(R * early))
    deltas = np.geomspace(1e-6 * R, deepest, 400)
    radii = np.array([radius(number, delta, *STEEL) for delta in deltas])
    assert np.all(np.diff(radii) > 0)
    ratio = radii**2 / (R * deltas)  # 2: the truncated sphere; fits to finite elements go beyond
    assert np.all((ratio > 0.999) & (ratio < 4.0))


def test_the_range_of_stronge_ends_where_the_circle_is_as_wide_as_the_sphere():
    number = LAWS.index("stronge")
    assert radius(number, limit(number, *STEEL), *STEEL) == pytest.approx(STEEL[1], rel=1e-12)


def test_while_unloading_the_circle_follows_hertz():
    pair, contact = Pair(LAWS.index("stronge"), *STEEL), np.zeros(1, CONTACT)[0]
    load(contact, pair, 64e-6)
    largest = np.sqrt(0.035 * (2 * 64e-6 - (0.75 * np.pi * 1.1 * 345e6 / 115e9) ** 2 * 0.035))
    assert contact_radius(contact, pair, contact.F_m) == pytest.approx(largest)
    assert contact_radius(contact, pair, contact.F_m / 8.0) == pytest.approx(largest / 2.0)


@pytest.mark.parametrize("model", ["spring_mass", "rigid"])
def test_a_lumped_beam_has_no_patch(model):
    varied = {"beam_model": ["elastic", model], "load": ["contact_patch"] * 2}
    with pytest.raises(ValueError, match=rf"^run 1: load = 'contact_patch': .*{model}"):
        case_table(il.paper_impact(), il.Discretisation(), duration=1e-3, varied=varied)
