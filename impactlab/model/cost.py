"""The cost of a run, estimated before it is made."""

from typing import Any

import numpy as np

from impactlab.model.shapes import Rectangle
from impactlab.solver import BEAM_MODELS, SCHEMES, SUPPORTS

A_SECOND = 3e8
"""Units of `work` per second of one core; half of it or twice is possible."""
ANY_RUN = 2100.0
"""Cost of a run beside its `work`, in the same unit: about 7 µs."""
_ELASTIC = SUPPORTS.index("elastic")
_FIRST = np.array([[98.8, 237.7, 237.7], [237.7, 500.6, 12.36], [237.7, 12.36, 500.6]])
"""Lowest omega^2 over EI/(rho A L^4), of bending, by left and right end; pinned: by Rayleigh."""


def solved(cases: Any) -> Any:
    """Return the share of the nodes that the kernels solve: half of a symmetric beam's."""
    symmetric = cases["support_left"] == cases["support_right"]
    for kind in ("stiffness", "rotational_stiffness"):
        same = cases[f"{kind}_left"] == cases[f"{kind}_right"]
        symmetric = symmetric & (same | (cases["support_left"] != _ELASTIC))
    held = cases["axis_held_left"] == cases["axis_held_right"]
    symmetric = symmetric & (held | (cases["beam_model"] != BEAM_MODELS.index("von_karman")))
    middle = (cases["strike_position"] == 0.5) & (cases["further"] == 0)
    return np.where(symmetric & middle, 0.5, 1.0)


def _durations(cases: Any) -> Any:
    """Return the simulated time of all strikes over the duration."""
    interval = np.maximum(cases["strike_interval"] / cases["duration"], 1.0)
    return 1.0 + (cases["strikes"] - 1) * interval


def flies(cases: Any) -> Any:
    """Return whether nothing holds the beam, so that it moves off under the blow."""
    return _has_loose_ends(cases) & (cases["foundation_stiffness"] == 0.0)


def _has_loose_ends(cases: Any) -> Any:
    """Return whether its ends do not hold the beam."""
    (left, turn_left), (right, turn_right) = (_holds(cases, side) for side in ("left", "right"))
    turns = turn_left | turn_right
    return ~((left & right) | ((left | right) & turns))


def _holds(cases: Any, side: str) -> tuple[Any, Any]:
    """Return whether an end is held against deflection, and against rotation."""
    support, clamped = cases[f"support_{side}"], SUPPORTS.index("clamped")
    springs = (cases[f"{kind}stiffness_{side}"] > 0.0 for kind in ("", "rotational_"))
    against_w, against_turn = (spring & (support == _ELASTIC) for spring in springs)
    pinned = support == SUPPORTS.index("pinned")
    return against_w | pinned | (support == clamped), against_turn | (support == clamped)


def _kinds(cases: Any) -> tuple[tuple[Any, Any], Any, Any]:
    """Return kinds of both ends, elastic ones as pinned or free, and their flexibilities in m/N."""
    kinds, soft = [], []
    for side in ("left", "right"):
        support, spring = cases[f"support_{side}"], cases[f"stiffness_{side}"]
        elastic, held = support == _ELASTIC, spring > 0.0
        other = np.where(held, SUPPORTS.index("pinned"), SUPPORTS.index("free"))
        kinds.append(np.where(elastic, other, support))
        soft.append(np.where(elastic & held, 1.0 / np.where(held, spring, 1.0), 0.0))
    return (kinds[0], kinds[1]), soft[0], soft[1]


def node_steps(cases: Any) -> Any:
    """Return the estimated cost per run: the nodes that are solved times the time steps.

    cases: a record of solver.types.CASE, or an array of them. Their largest step is that of bending
    for the paper's beam by leapfrog, with a bar wave's for von Karman's, a bar wave's over a
    spacing for the modal scheme, and half of it, roughly, for the other models of the beam. Any
    section counts as the rectangle around it.
    """
    dx = cases["beam_span"] / (cases["nodes"] - 1)
    section = Rectangle(cases["beam_width"], cases["beam_depth"])
    wave = dx * np.sqrt(cases["beam_density"] / cases["beam_youngs_modulus"])
    bending = 0.5 * wave * dx * np.sqrt(section.area / section.second_moment)
    bends = cases["beam_model"] <= BEAM_MODELS.index("elastic")
    modal = cases["scheme"] == SCHEMES.index("modal")
    stretches = cases["beam_model"] == BEAM_MODELS.index("von_karman")
    beside = bending / np.sqrt(1.0 + stretches * (bending / wave) ** 2)
    largest = np.where(bends | stretches, beside, 0.5 * wave)
    lag = cases["stiffness_damping"] / largest
    largest = np.where(modal, wave, largest * (np.sqrt(1.0 + lag * lag) - lag))
    run = solved(cases) * cases["nodes"] * cases["duration"] / (cases["courant"] * largest)
    return run * _durations(cases)


_RATES = (0.15, 0.13, 0.15, 1.2, 0.0, 0.0)
_BESIDES = (20.0, 20.0, 20.0, 35.0, 32.0, 29.0)
"""By beam model: cost of a node per step of leapfrog, and of a step beside its nodes. All costs are
fitted to `tests/benchmarks/cost.py`."""
_TOUCH = 10.0  # further cost of a step in contact
_MODE, _MODES_BESIDES = 0.13, 10.8
"""Cost of a mode per step in contact, and of a step beside its modes."""
_YIELDING, _YIELDING_BESIDES = 1.4, 22.0
"""The same of a step with yielding sections, which alone make the modal scheme go step by step
after the contact."""
_CONTACTS = 3.0  # time in contact, sub-impacts and all, over that of Hertz on a half-space
_LUMPED = 1000.0  # steps of a lumped model in the largest one


def work(cases: Any) -> Any:
    """Return the estimated time per run, of which A_SECOND are a second.

    Beyond `node_steps`, this counts the time step that a light sphere or a stiff contact needs
    (Hertz's stiffness at the indentation that takes all of the sphere's energy) and the cost per
    step of each beam model and scheme, on the rectangle around the section. Yielding fibres may
    cost leapfrog several times as much.
    """
    nodes, model = cases["nodes"], cases["beam_model"]
    lumped = model >= BEAM_MODELS.index("spring_mass")
    radius, mass = cases["sphere_radius"], cases["sphere_mass"]
    hertz, indentation = _hertz(cases)
    stiffness = 1.5 * hertz * np.sqrt(np.minimum(indentation, radius))
    dx = cases["beam_span"] / (nodes - 1)
    section = Rectangle(cases["beam_width"], cases["beam_depth"])
    node = section.mass_per_length(cases["beam_density"]) * dx
    # the largest step of the sphere, and of the beam's middle node if any, on that spring
    step = 2.0 / np.sqrt(stiffness * (1.0 / mass + np.where(lumped, 0.0, 1.0 / node)))
    contact = cases["duration"] / (cases["courant"] * step)
    nodes = solved(cases) * nodes
    bending = node_steps(cases) / nodes / _durations(cases)
    steps = 1.0 + np.where(lumped, _LUMPED * contact, np.hypot(bending, contact))
    # a faster sphere touches again more often, for all that its first contact is shorter
    again = (cases["velocity"] / 2.0) ** 0.1
    in_contact = np.minimum(again * contact_time(cases) / cases["duration"], 1.0)
    touch = np.where(lumped, 0.0, _TOUCH * in_contact)
    leapfrog = steps * (nodes * np.take(_RATES, model) + np.take(_BESIDES, model) + touch)
    touching = nodes * _MODE + _MODES_BESIDES
    yielding = nodes * _YIELDING + _YIELDING_BESIDES
    # A beam that is given the velocity v at a point has there the strain sqrt(3) v/c, c of a bar
    # wave (Boussinesq). The share of steps in which sections yield, or are about to, grows from
    # none where this yields to all at four times it, as fitted to measured times.
    stress = np.sqrt(3.0 * cases["beam_density"] * cases["beam_youngs_modulus"]) * cases["velocity"]
    beyond = np.clip((stress / cases["beam_yield_stress"] - 1.0) / 3.0, 0.0, 1.0)
    share = np.where(model == BEAM_MODELS.index("elastic"), 0.0, beyond * beyond)
    modal = in_contact * touching + share * yielding
    run = np.where(cases["scheme"] == SCHEMES.index("modal"), steps * modal, leapfrog)
    return run * _durations(cases)


def contact_time(cases: Any) -> Any:
    """Return an upper estimate of the time in contact of a run, or of each, in s."""
    _, indentation = _hertz(cases)
    return _CONTACTS * 2.94 * indentation / cases["velocity"]


def swing(cases: Any) -> Any:
    """Return an upper estimate of the time in s in which sphere and beam swing once, of each run.

    That is the period of the sphere on the bending stiffness, and of the beam alone (Dunkerley: the
    squares add up to a longer one than theirs together), and the time in which a plastic hinge
    under the sphere stops it. A rigid beam does not swing; one that flies counts as pinned.
    """
    span, metal = cases["beam_span"], cases["beam_youngs_modulus"] / cases["beam_density"]
    flexibility, lever = _statics(cases)
    stiffness = metal * cases["rotary_inertia"] / span**3
    beam = cases["mass_per_length"] * span
    ends, soft_left, soft_right = _kinds(cases)
    first = _FIRST[ends[0], ends[1]]
    yields = cases["beam_model"] != BEAM_MODELS.index("elastic")
    collapse = cases["beam_yield_stress"] * cases["plastic_modulus"] / (lever * span)
    hinge = yields * cases["sphere_mass"] * cases["velocity"] / collapse
    square = (cases["sphere_mass"] * flexibility + beam / first) / stiffness
    x, y = cases["strike_position"], 1.0 - cases["strike_position"]
    square = square + cases["sphere_mass"] * (y * y * soft_left + x * x * soft_right)
    bed = cases["foundation_stiffness"] * span
    floats = _has_loose_ends(cases) & (bed > 0.0)
    rocking = (1.0 + 12.0 * (x - 0.5) ** 2) * cases["sphere_mass"] + beam
    square = square + np.where(floats, rocking / np.where(floats, bed, 1.0), 0.0)
    period = 2.0 * np.pi * np.sqrt(square + 0.5 * beam * (soft_left + soft_right))
    return np.where(cases["beam_model"] == BEAM_MODELS.index("rigid"), 0.0, period + hinge)


def _statics(cases: Any) -> tuple[Any, Any]:
    """Return the static deflection under a force there, over F L^3/(EI), and the lever over L.

    The moment of a hinge there under the force is at most the force times the lever.
    """
    clamped, free = SUPPORTS.index("clamped"), SUPPORTS.index("free")
    ends, place = _kinds(cases)[0], cases["strike_position"]
    # x: from the clamped end, or the left one
    x = np.where((ends[1] == clamped) & (ends[0] != clamped), 1.0 - place, place)
    one = (ends[0] == clamped) != (ends[1] == clamped)
    both = (ends[0] == clamped) & (ends[1] == clamped)
    cantilever = one & ((ends[0] == free) | (ends[1] == free))
    y = 1.0 - x
    flexibility = np.select(
        [both, cantilever, one],
        [x**3 * y**3 / 3.0, x**3 / 3.0, x**3 * y**2 * (4.0 - x) / 12.0],
        x**2 * y**2 / 3.0,
    )
    return flexibility, np.where(cantilever, x, np.maximum(x * y, 1e-3))


def _hertz(cases: Any) -> tuple[Any, Any]:
    """Return Hertz's F/d^1.5, and the indentation that takes all of the sphere's energy; SI."""
    compliance = sum(
        (1.0 - cases[f"{body}_poissons_ratio"] ** 2) / cases[f"{body}_youngs_modulus"]
        for body in ("sphere", "beam")
    )
    hertz = 4.0 / 3.0 / compliance * np.sqrt(cases["sphere_radius"])
    return hertz, (1.25 * cases["sphere_mass"] * cases["velocity"] ** 2 / hertz) ** 0.4


def memory(cases: Any) -> Any:
    """Return the estimated memory of the march per run, in bytes."""
    modes = np.where(cases["scheme"] == SCHEMES.index("modal"), 2.0 * cases["nodes"], 0.0)
    whole = 1.0 + (cases["beam_model"] == BEAM_MODELS.index("von_karman"))  # of the depth
    return cases["nodes"] * (80.0 * whole + 4.0 * whole * cases["points"] + modes)
