"""Contact laws: the registry. The equations of a law are in the file of its name.

A new law takes a file with the functions `curve`, `limit` and `radius`, a viscous one `damping`,
too (see hertz.py), and an entry at the end of the registry. This file stays free of numba, so that
laws can be listed without compiling any.
"""

import math
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, kw_only=True)
class LawRecord:
    """A contact law: its name, where it comes from, how far it holds, and how sure we are.

    short: the name as figures write it. title: in words. source: whom it follows, and where its
    equations are from. holds_for: its range. unconfirmed: what of it was not confirmed by the
    primary source or by public code written after it; "" where all was. flaws: jumps, energy that
    it creates, dents below zero, for steel where the law is not free of such; "" if there are none.

    The tests hold the law to numbers, for steel (E* = 115 GPa, S_y = 345 MPa, nu = 0.3).
    yield_pressure: the largest Hertz pressure at first yield over S_y. jumps: of the loading force:
    (indentation over that of first yield, relative height) each. unloading_start: the force at the
    start of unloading over the loading force, at the worst. restitution: the largest. creates: from
    and to which indentation, over that of first yield, the law creates energy. dent: the lowest
    residual over the largest indentation.
    """

    name: str
    short: str = ""
    title: str = ""
    source: str = ""
    holds_for: str = ""
    unconfirmed: str = ""
    flaws: str = ""
    yield_pressure: float = 1.295 * math.exp(0.736 * 0.3)
    jumps: tuple[tuple[float, float], ...] = ()
    unloading_start: float = 1.0
    restitution: float = 1.0
    creates: tuple[float, float] = (1.0, 1.0)
    dent: float = 0.0


_CIRCLE = (
    "contact circle small beside the sphere; the source gives no number, so the limit here is a "
    "circle as wide as the sphere"
)
_READ = "read in public code written after the paper, not in the paper itself"

_REGISTRY = (
    LawRecord(
        name="hertz",
        short="Hertz",
        title="Hertz",
        source="Hertz 1881; Johnson, Contact Mechanics (1985), eq. 4.23",
        holds_for=f"elastic bodies, {_CIRCLE} (indentation up to the sphere's radius)",
    ),
    LawRecord(
        name="stronge",
        short="Stronge",
        title="Stronge, unloading after Wang et al.",
        source=(
            "Stronge, Impact Mechanics (2000), chapter 6; unloading with force continuity after "
            "Wang et al., as in the paper's Table 1 and Eqs. 15 to 17"
        ),
        holds_for=f"{_CIRCLE} (indentation up to half its radius)",
        flaws=(
            "It creates energy where the largest indentation lies between 1 and 2.673 times that "
            "of first yield: the coefficient of restitution of the contact alone is up to 1.101 "
            "there, and the contact dissipation below zero. Up to 1.998 times it, it leaves a "
            "dent below zero."
        ),
        yield_pressure=1.65,
        restitution=1.1008,
        creates=(1.0, 2.673),
        dent=-0.04057,
    ),
    LawRecord(
        name="stronge_original",
        short="Stronge, original",
        title="Stronge",
        source="Stronge, Impact Mechanics (2000), chapter 6, with its own unloading",
        holds_for=f"{_CIRCLE} (indentation up to half its radius)",
        unconfirmed=(
            "the joint of the elastic-plastic and the fully plastic regime, which is put where "
            "the two forces agree"
        ),
        flaws=(
            "Unloading begins below the loading force, by up to 60.7 % (from 82.511 times the "
            "indentation of first yield on). It creates energy where the largest indentation "
            "lies between 1 and 1.253 times that of first yield (restitution up to 1.0123)."
        ),
        yield_pressure=1.65,
        unloading_start=1.1 / 2.8,
        restitution=1.0123,
        creates=(1.0, 1.2526),
    ),
    LawRecord(
        name="jackson_green",
        short="Jackson-Green",
        title="Jackson and Green",
        source=(
            "Jackson and Green 2005 (J. Tribology 127, 343); unloading: Jackson, Chusoipin and "
            "Green 2005 (J. Tribology 127, 484)"
        ),
        holds_for=(
            "contact radius up to 0.41 of the sphere's, and indentation up to 4725 times that of "
            "first yield, where the fit of the unloading ends"
        ),
        unconfirmed=f"all constants: {_READ}",
        flaws="The force jumps up by 0.47 % at 1.9 times the indentation of first yield.",
        jumps=((1.9, 0.00474),),
    ),
    LawRecord(
        name="mjg",
        short="MJG",
        title="Modified Jackson and Green",
        source=(
            "loading: Ghaednia, Brake, Berryhill and Jackson 2019 (J. Tribology 141), eqs. 5, 6, "
            "23, 24 and 27 to 29, without hardening; unloading: Jackson, Chusoipin and Green 2005"
        ),
        holds_for=(
            "contact radius up to that of the sphere, where its hardness stops falling, and "
            "indentation up to 4725 times that of first yield, where the fit of the unloading "
            "ends"
        ),
        unconfirmed=(
            f"all constants: {_READ}; the range; the earlier form of Ghaednia, Marghitu and "
            "Jackson 2015 (0.17 for 1/4, 1/78 for 1/25) is only remembered, drops by 10.7 % at "
            "its onset, and is not used, nor is its unloading"
        ),
        flaws="The force jumps up by 0.47 % at 1.9 times the indentation of first yield.",
        jumps=((1.9, 0.00470),),
    ),
    LawRecord(
        name="thornton",
        short="Thornton",
        title="Thornton",
        source="Thornton 1997 (J. Applied Mechanics 64, 383); Thornton and Ning 1998",
        holds_for=f"{_CIRCLE} (indentation up to its radius)",
        unconfirmed="the limiting pressure of 1.6 yield stresses",
        flaws=(
            "Far softer than the others when deep: its limiting pressure is that of first yield, "
            "and not the hardness."
        ),
        yield_pressure=1.6,
    ),
    LawRecord(
        name="kogut_etsion",
        short="Kogut-Etsion",
        title="Kogut and Etsion, unloading after Etsion, Kligerman and Kadin",
        source=(
            "Kogut and Etsion 2002 (J. Applied Mechanics 69, 657); Etsion, Kligerman and Kadin "
            "2005 (Int. J. Solids and Structures 42, 3716)"
        ),
        holds_for=(
            "indentation up to 110 times that of first yield, where the fits end; beyond, full "
            "plasticity at the hardness of 2.8 yield stresses"
        ),
        unconfirmed=(
            f"loading: {_READ}; the three constants of the unloading (0.28, 0.69, 0.0331) are "
            "only remembered"
        ),
        flaws=(
            "The force jumps up by 3.0 %, 1.7 % and 7.9 % at 1, 6 and 110 times the indentation "
            "of first yield. It creates energy from 1 to 1.248 times that of first yield "
            "(restitution up to 1.0149)."
        ),
        yield_pressure=2.8 * (0.454 + 0.41 * 0.3),
        jumps=((1.0, 0.03), (6.0, 0.016788), (110.0, 0.078776)),
        restitution=1.01489,
        creates=(1.0, 1.2483),
    ),
    LawRecord(
        name="brake",
        short="Brake",
        title="Brake's unloading on the modified Jackson and Green loading",
        source=(
            "loading: that of mjg; unloading: Brake 2015 (Int. J. Solids and Structures 62, 104)"
        ),
        holds_for=(
            "contact radius up to that of the sphere, where the loading's hardness stops falling"
        ),
        unconfirmed=f"all constants: {_READ}; the range; the loading is not Brake's own",
        flaws=(
            "The force jumps up by 0.47 % at 1.9 times the indentation of first yield. From "
            "there to 2.00 times it, it creates energy (restitution up to 1.0047) and leaves a "
            "dent below zero."
        ),
        jumps=((1.9, 0.00470),),
        restitution=1.0047,
        creates=(1.9, 2.0011),
        dent=-0.0047,
    ),
    LawRecord(
        name="abbott_firestone",
        short="Abbott-Firestone",
        title="Abbott and Firestone, after Hertz",
        source=(
            "Abbott and Firestone 1933 (Mechanical Engineering 55, 569), as in Jackson and Green "
            "2005 (J. Tribology 127, 343)"
        ),
        holds_for=f"full plasticity, {_CIRCLE} (indentation up to half its radius)",
        unconfirmed=(
            "that it describes contact at all, since it was meant for wear; the hardness of 2.8 "
            "yield stresses; the onset of full plasticity, which is put where its force is that of "
            "Hertz; the unloading, for which Hertz's curve is taken"
        ),
        flaws="Stiff, and elastic too long: nothing yields before full plasticity.",
        yield_pressure=3.0 * 2.8,
    ),
    LawRecord(
        name="stronge_consistent",
        short="Stronge, consistent",
        title="Stronge, loading capped by Hertz",
        source=(
            "stronge, its loading at most Hertz's force; unloading with force continuity after "
            "Wang et al."
        ),
        holds_for=f"{_CIRCLE} (indentation up to half its radius)",
        unconfirmed=(
            "the cap, which is no paper's: it is put there because Stronge's loading exceeds "
            "Hertz's up to 15.416 times the indentation of first yield"
        ),
        yield_pressure=1.65,
    ),
    LawRecord(
        name="finite_element",
        short="finite elements",
        title="Fit to finite elements",
        source=(
            "an axisymmetric quasi-static finite-element solve over the metals of both bodies, "
            "loading and unloading: tests/benchmarks/sphere_indentation.py and contact_law.py"
        ),
        holds_for=(
            "indentation up to 0.045 of the sphere's radius, or 0.024 where E*/S_y is above 505; "
            "E*/S_y from 60 to 1500; of the softer body, Poisson's ratio from 0.05 to 0.45, "
            "hardening up to 0.05 of Young's modulus, a third to ten times less stiff than the "
            "other"
        ),
        yield_pressure=1.6128,
    ),
    LawRecord(
        name="hunt_crossley",
        short="Hunt-Crossley",
        title="Hunt and Crossley",
        source="Hunt and Crossley 1975 (J. Applied Mechanics 42, 440), with Hertz's stiffness",
        holds_for=f"viscous bodies that do not yield, {_CIRCLE} (indentation up to its radius)",
        unconfirmed=(
            "that metal loses energy like this; the loss of restitution of 0.08 per m/s, which is "
            "remembered as the lower end of 0.08 to 0.32 for steel, bronze and ivory"
        ),
    ),
)
CONTACT_LAWS: dict[str, LawRecord] = {law.name: law for law in _REGISTRY}
"""The laws by name; those that the user registers (model/contact_law.py) are added."""
LAWS = tuple(CONTACT_LAWS)
"""The names of those of this package; the index is the kernels' switch."""
NUMBERED: dict[int, Any] = {}
"""Laws from outside by their numbers, those of an earlier source included."""
