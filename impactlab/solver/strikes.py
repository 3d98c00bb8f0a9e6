"""Between two strikes: whether the spheres have left, and what the beam rests in."""

from collections.abc import Callable

import numpy as np

from impactlab.solver import kink, responses
from impactlab.solver.fibre_plasticity import plastic_energy
from impactlab.solver.jit import compiled, inlined
from impactlab.solver.state import BeamModel, State
from impactlab.solver.types import Array, Record


def resting(model: BeamModel) -> Callable[..., int]:
    """Return a function that puts the beam to rest after a strike, unless it goes on moving."""
    settle, lift, rest_remarks = model.settle, model.lift, model.rest_remarks
    leaves = departure(model)
    rise = None if model.further is None else model.further.rise

    @compiled
    def rest(
        case: Record,
        answer: Record,
        contact: Record,
        events: Record,
        series: Array,
        state: State,
        strike: int,
        now: int,
    ) -> int:
        """Fill in the row of outputs.SERIES, if any; return which row of beam.w is the next.

        now: the last row of the strike.
        """
        row, last = 1 - now, strike == case.strikes - 1
        if settle is not None and (last or case.strike_interval == 0.0):
            settle(state)
            if rest_remarks is not None:
                answer.remarks |= rest_remarks(state)
            events.v_mid, row = 0.0, int(np.int64(0))
        elif leaves(state, events):  # on as it was, beyond the kink
            kink.straighten(state.beam.w, state.grid, -contact.kink)
        pair, section, grid, beam, plastic = state[:5]
        dent, w = contact.delta_r, beam.w[row, grid.mid] - kink.height(grid, contact.kink)
        w += contact.sunk
        if rise is not None:
            w -= rise(state)
        if lift is not None:
            dent += lift(state, contact, 0.0)
        if strike < series.shape[0]:
            _, yielded = plastic_energy(plastic, section, grid)
            responses.read_strike(series[strike], dent, w, yielded, case, events, contact, pair)
        if last:
            kink.straighten(beam.w, grid, contact.kink)
        return row

    return rest


def resting_once(rest: Callable[..., int], extended: bool) -> Callable[..., None]:
    """Return a function that puts a beam to rest after its only strike, where that is kept.

    extended: only kernels that are do; in others it does nothing.
    """

    @compiled
    def rest_single(
        case: Record, answer: Record, contact: Record, events: Record, series: Array, state: State
    ) -> None:
        if extended and case.strikes == 1 and series.shape[0] > 0:
            rest(case, answer, contact, events, series, state, 0, 0)

    return rest_single


def departure(model: BeamModel) -> Callable[..., bool]:
    """Return a function that tells whether all spheres of a strike move away."""
    leave = None if model.further is None else model.further.leave

    @inlined
    def leaves(state: State, events: Record) -> bool:
        if leave is not None and not leave(state):
            return False
        return bool(responses.sphere_leaves(events))

    return leaves
