"""Fibres that follow a flow law from outside, in place of linear hardening.

A fibre that flows has the stress over its back stress sigma(p, p'), with p its equivalent plastic
strain (PEEQ) and p' the rate of it. A step of dt that would take the fibre elastically to the
stress `trial` lets a PEEQ of dp flow, the root of

    |trial| - (E + H_k) dp = sigma(p + dp, dp/dt)

(backward Euler, as box 1.5 of Simo and Hughes, Computational Inelasticity). The left side falls
and the right side does not, so there is one root, between 0 and |trial|/(E + H_k). Of the work that
is dissipated, S_y p is counted as with linear hardening, and the rest, of sigma - S_y, is summed by
the trapezoidal rule.
"""

import math
from collections.abc import Callable
from typing import Any

from impactlab.solver import section
from impactlab.solver.jit import compiled
from impactlab.solver.strain_rate import RateLaw
from impactlab.solver.types import Record

_ROUND_OFF = 1e-12
"""A fibre so near its flow stress, in shares of it, yields."""
_ROOT = 1e-13
_ITERATIONS = 200
_BISECTED = 3
"""Every such iteration halves the interval, whatever regula falsi does."""


def _slip_of(flow_stress: Callable[..., float]) -> Callable[..., float]:
    """Return slip(trial, peeq, stiffness, dt, E, S_y): the PEEQ that flows in a step."""

    def slip(trial: float, peeq: float, stiffness: float, dt: float, E: float, S_y: float) -> float:
        low, high = 0.0, trial / stiffness
        above, below = (
            trial - flow_stress(peeq, 0.0, E, S_y),
            -flow_stress(peeq + high, high / dt, E, S_y),
        )
        for iteration in range(_ITERATIONS):
            middle = 0.5 * (low + high)
            if iteration % _BISECTED > 0:
                middle = low + (high - low) * above / (above - below)
            excess = trial - stiffness * middle - flow_stress(peeq + middle, middle / dt, E, S_y)
            if excess > 0.0:
                low, above = middle, excess
            else:
                high, below = middle, excess
            if abs(excess) <= _ROOT * trial or high - low <= _ROOT * high:
                return middle
        return 0.5 * (low + high)

    slip.__qualname__ = "slip_of_law"
    return slip


def substitutes(law: Any) -> dict[Any, Any]:
    """Return what takes the place of functions of section.py in kernels of a flow law."""
    flow_stress: Callable[..., float] = law.flow_stress
    slip_in, number = _slip_of(flow_stress), law.number

    def flow_at_rate(
        moduli: section.Moduli,
        rate: RateLaw,
        trial: float,
        growth: float,
        plastic_strain: float,
        peeq: float,
        dt: float,
    ) -> tuple[float, float, float]:
        E, S_y, _, H_k = moduli
        static = flow_stress(peeq, 0.0, E, S_y)
        if abs(trial) <= static * (1.0 + _ROUND_OFF):
            return plastic_strain, peeq, 0.0
        slip = slip_in(abs(trial), peeq, E + H_k, dt, E, S_y)
        start = max(abs(trial - growth), static)
        end = abs(trial) - (E + H_k) * slip
        work = (0.5 * (start + end) - S_y) * slip
        return plastic_strain + math.copysign(slip, trial), peeq + slip, work

    def elastic_range(
        plastic_strain: float, peeq: float, E: float, S_y: float, H_i: float, H_k: float
    ) -> tuple[float, float]:
        centre = plastic_strain * (1.0 + H_k / E)
        radius = flow_stress(peeq, 0.0, E, S_y) / E
        return centre - radius, centre + radius

    def fibre_rate(case: Record) -> RateLaw:
        return RateLaw(1.0 if case.beam_flow_law == number else 0.0, 0.0, 0.0)

    links: dict[Any, Any] = {
        section.flow_at_rate: flow_at_rate,
        section.elastic_range: elastic_range,
        section.fibre_rate: fibre_rate,
    }
    for function in links.values():  # named alike in every process
        function.__qualname__ = f"{function.__name__}_of_law"
    return {original: compiled(function) for original, function in links.items()}
