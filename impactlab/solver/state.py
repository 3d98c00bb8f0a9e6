"""The state of a run, and the functions that a model of the beam is made of."""

from collections.abc import Callable
from typing import Any, NamedTuple

from impactlab.solver.beam import BeamGrid, BeamState
from impactlab.solver.contact.history import Pair
from impactlab.solver.fibre_plasticity import PlasticState
from impactlab.solver.section import FibreSection


class State(NamedTuple):
    """The state that a run marches: contact pair, section and grid, and the beam.

    extra: the further state of the model of the beam, in a type of its own.
    """

    pair: Pair
    section: FibreSection
    grid: BeamGrid
    beam: BeamState
    plastic: PlasticState
    extra: Any


class Flight(NamedTuple):
    """Compiled functions with which a model leaps over steps without contact.

    leap(state, now, gap, sphere, w_max, room): make many steps at once; return how many, 0 where an
    event may be near. beam.w and beam.u at mid-span follow. retrace(state): make the steps of the
    last leap one by one, aside; return deflection (m) and curvature (1/m) of mid-span after the
    next. largest(state, w_max): the largest deflection, of the leaps, too (m). land(state, w):
    forget all leaps so far; mid-span is at w (m).
    """

    leap: Callable[..., int]
    retrace: Callable[..., tuple[float, float]]
    largest: Callable[..., float]
    land: Callable[..., None]


class FurtherSpheres(NamedTuple):
    """Compiled functions of a model that moves further spheres with the beam.

    join(state, table, r, case): State.extra of run r with them, from a table made outside. read(
    state, case, answer, answers): fill in their answers, and what they add to the run's. brought(
    state): the kinetic energy (J) with which those came that have touched the beam. rise(state):
    how far their kinks raise the struck node (m). leave(state): whether all that came move away.
    take_away(state): take them away, before the beam is struck again while it moves; work(state):
    what they have given to the beam by then (J). again(state, strike): let them come again, once so
    many strikes are over.
    """

    join: Callable[..., Any]
    read: Callable[..., None]
    brought: Callable[..., float]
    rise: Callable[..., float]
    leave: Callable[..., bool]
    take_away: Callable[..., None]
    work: Callable[..., float]
    again: Callable[..., None]


class BeamModel(NamedTuple):
    """A model of the beam in one scheme: compiled functions, from which kernels.py makes a kernel.

    make(case, section, grid): State.extra at rest. renew(extra, case, section, grid): put it
    back to rest, for another case of as many nodes; None: `make` does. take(extra, table): hand on
    a table of modes made outside, if any. step(state, now, F): move the beam
    under the contact force F (N). curvature(state, now): at mid-span, 1/m. energy(state, now, F,
    u_mid): the beam's in J, plastic strains' included, after a step, at its beginning; u_mid: u at
    mid-span before it (m). deflect(state, now): set all of beam.w[now] in the end. spread(state,
    now, F, a): spread the force of a step just made over the contact radius a (contact_patch.py);
    return how far the mean under it has moved beyond mid-span (m), and what `energy` lacks (J).
    flight_stride: steps between two audits of the energy without contact, at least. flight: see
    above. sag(state): how far the middle of mid-span's section lies below its mean, m; None: not at
    all. beneath(state, now, F): how far the axis lies below that, m; lift(state, contact, F): how
    far the contact lifts it, m. moments(state, now): at mid-span, along the beam and across its
    width, both times the width, N m. bend_back(state, now, contact, growth): let the
    kink of kink.py grow by so much, rad. section: functions that make room for a section and cut
    it; None: those of section.py for half of the fibres. settle(state): put it to rest, as its
    plastic strains leave it (settle.py); None: it cannot be struck twice. rest_remarks(
    state): bits of remarks on its shape then; None: there are none. push(state, now, nodes,
    forces): add forces (N) on nodes other than the struck one to a step just made, and set beam.w
    and beam.u there; return what `energy` has too much then (J). further: see above.
    """

    make: Callable[..., Any]
    step: Callable[..., None]
    curvature: Callable[..., float]
    energy: Callable[..., float]
    deflect: Callable[..., None]
    spread: Callable[..., tuple[float, float]]
    settle: Callable[..., None] | None
    flight_stride: int = 1
    flight: Flight | None = None
    renew: Callable[..., None] | None = None
    take: Callable[..., None] | None = None
    sag: Callable[..., float] | None = None
    beneath: Callable[..., float] | None = None
    lift: Callable[..., float] | None = None
    moments: Callable[..., tuple[float, float]] | None = None
    bend_back: Callable[..., None] | None = None
    section: tuple[Callable[..., Any], Callable[..., Any]] | None = None
    rest_remarks: Callable[..., int] | None = None
    push: Callable[..., float] | None = None
    further: FurtherSpheres | None = None
