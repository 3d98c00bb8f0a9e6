"""What is known about each contact law: where it comes from, how far it holds, how sure we are.

The entries name the laws, in the order of the kernels' numbers; the laws are in the files of the
same names. Numbers in `flaws` are for steel (E* = 115 GPa, S_y = 345 MPa, nu = 0.3) where the law
is not free of such; tests/unit/solver/contact/test_laws.py measures them.
"""

from __future__ import annotations

from typing import NamedTuple


class About(NamedTuple):
    """title: in words. source: whom it follows, and where its equations are from. holds: its range.

    unconfirmed: what of it was not confirmed by the primary source or by public code written
    after it; "" where all was. flaws: jumps, energy that it creates, dents below zero; "" if none.
    """

    title: str
    source: str
    holds: str
    unconfirmed: str = ""
    flaws: str = ""


_CIRCLE = (
    "contact circle small beside the sphere; the source gives no number, so the limit here is a "
    "circle as wide as the sphere"
)
_READ = "read in public code written after the paper, not in the paper itself"

ABOUT: dict[str, About] = {
    "hertz": About(
        "Hertz",
        "Hertz 1881; Johnson, Contact Mechanics (1985), eq. 4.23",
        f"elastic bodies, {_CIRCLE} (indentation up to the sphere's radius)",
    ),
    "stronge": About(
        "Stronge, unloading after Wang et al.",
        "Stronge, Impact Mechanics (2000), chapter 6; unloading with force continuity after Wang "
        "et al., as in the paper's Table 1 and Eqs. 15 to 17",
        f"{_CIRCLE} (indentation up to half its radius)",
        "",
        "It creates energy where the largest indentation lies between 1 and 2.673 times that of "
        "first yield: the coefficient of restitution of the contact alone is up to 1.101 there, "
        "and the contact dissipation below zero. Up to 1.998 times it, it leaves a dent below "
        "zero.",
    ),
    "stronge_original": About(
        "Stronge",
        "Stronge, Impact Mechanics (2000), chapter 6, with its own unloading",
        f"{_CIRCLE} (indentation up to half its radius)",
        "the joint of the elastic-plastic and the fully plastic regime, which is put where the "
        "two forces agree",
        "Unloading begins below the loading force, by up to 60.7 % (from 82.511 times the "
        "indentation of first yield on). It creates energy where the largest indentation lies "
        "between 1 and 1.253 times that of first yield (restitution up to 1.0123).",
    ),
    "jackson_green": About(
        "Jackson and Green",
        "Jackson and Green 2005 (J. Tribology 127, 343); unloading: Jackson, Chusoipin and Green "
        "2005 (J. Tribology 127, 484)",
        "contact radius up to 0.41 of the sphere's, and indentation up to 4725 times that of first "
        "yield, where the fit of the unloading ends",
        f"all constants: {_READ}",
        "The force jumps up by 0.47 % at 1.9 times the indentation of first yield.",
    ),
    "mjg": About(
        "Modified Jackson and Green",
        "loading: Ghaednia, Brake, Berryhill and Jackson 2019 (J. Tribology 141), eqs. 5, 6, 23, "
        "24 and 27 to 29, without hardening; unloading: Jackson, Chusoipin and Green 2005",
        "contact radius up to that of the sphere, where its hardness stops falling, and "
        "indentation up to 4725 times that of first yield, where the fit of the unloading ends",
        f"all constants: {_READ}; the range; the earlier form of Ghaednia, Marghitu and Jackson "
        "2015 (0.17 for 1/4, 1/78 for 1/25) is only remembered, drops by 10.7 % at its onset, and "
        "is not used, nor is its unloading",
        "The force jumps up by 0.47 % at 1.9 times the indentation of first yield.",
    ),
    "thornton": About(
        "Thornton",
        "Thornton 1997 (J. Applied Mechanics 64, 383); Thornton and Ning 1998",
        f"{_CIRCLE} (indentation up to its radius)",
        "the limiting pressure of 1.6 yield stresses",
        "Far softer than the others when deep: its limiting pressure is that of first yield, and "
        "not the hardness.",
    ),
    "kogut_etsion": About(
        "Kogut and Etsion, unloading after Etsion, Kligerman and Kadin",
        "Kogut and Etsion 2002 (J. Applied Mechanics 69, 657); Etsion, Kligerman and Kadin 2005 "
        "(Int. J. Solids and Structures 42, 3716)",
        "indentation up to 110 times that of first yield, where the fits end; beyond, full "
        "plasticity at the hardness of 2.8 yield stresses",
        f"loading: {_READ}; the three constants of the unloading (0.28, 0.69, 0.0331) are only "
        "remembered",
        "The force jumps up by 3.0 %, 1.7 % and 7.9 % at 1, 6 and 110 times the indentation of "
        "first yield. It creates energy from 1 to 1.248 times that of first yield (restitution up "
        "to 1.0149).",
    ),
    "brake": About(
        "Brake's unloading on the modified Jackson and Green loading",
        "loading: that of mjg; unloading: Brake 2015 (Int. J. Solids and Structures 62, 104)",
        "contact radius up to that of the sphere, where the loading's hardness stops falling",
        f"all constants: {_READ}; the range; the loading is not Brake's own",
        "The force jumps up by 0.47 % at 1.9 times the indentation of first yield. From there to "
        "2.00 times it, it creates energy (restitution up to 1.0047) and leaves a dent below zero.",
    ),
}
