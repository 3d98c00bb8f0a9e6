"""The first integral of Hunt and Crossley's impact against its equation of motion."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from impactlab.verification.solutions import hertz
from impactlab.verification.solutions.hertz import HuntCrossleyImpact

MASS, K = 1.4, 2.9e10


@pytest.mark.parametrize("velocity", [0.1, 1.0, 10.0])
def test_it_is_the_solution_of_the_equation_of_motion(velocity):
    impact = HuntCrossleyImpact(MASS, velocity, K)

    def force(y):
        return K * max(y[0], 0.0) ** 1.5 * (1.0 + 1.5 * impact.alpha * y[1])

    def left(t, y):
        return y[0] if t > 0 else 1.0

    left.terminal, left.direction = True, -1
    motion = solve_ivp(
        lambda t, y: (y[1], -force(y) / MASS), (0.0, 1.0), (0.0, velocity), "DOP853",
        events=left, rtol=1e-11, atol=1e-16, max_step=5e-7,
    )  # fmt: skip
    deepest = motion.y[:, np.argmax(motion.y[0])]
    assert impact.maximum_indentation == pytest.approx(deepest[0], rel=1e-4)
    assert impact.restitution == pytest.approx(-motion.y[1, -1] / velocity, rel=1e-6)
    assert impact.peak_force == pytest.approx(max(map(force, motion.y.T)), rel=1e-4)
    middle = motion.y[:, np.argmin(abs(motion.y[1] - 0.5 * velocity))]
    assert impact.indentation(middle[1]) == pytest.approx(middle[0], rel=1e-7)


def test_slow_impacts_lose_alpha_times_the_velocity():
    slow = HuntCrossleyImpact(MASS, 1e-2, K)
    assert slow.restitution == pytest.approx(1.0 - slow.alpha * 1e-2, abs=1e-6)
    expected = hertz.maximum_indentation(MASS, 1e-2, 0.75 * K, 1.0)
    assert slow.maximum_indentation == pytest.approx(expected, rel=1e-3)
