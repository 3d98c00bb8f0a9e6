"""Registration of contact laws from outside the package."""

from __future__ import annotations

from impactlab.model.checks import instance
from impactlab.model.contact_law import ContactLaw, adopt
from impactlab.verification.law_record import impossible, lines, refusals


def register(law: ContactLaw) -> ContactLaw:
    """Check a contact law of one's own, print the numbers of its record, and let studies use it.

    Registered again under the same name, a law takes the earlier one's place; stored answers are
    kept apart by the hashes of the sources.

    Parameters
    ----------
    law : ContactLaw
        Law.

    Returns
    -------
    ContactLaw
        The same law.

    Raises
    ------
    ValueError
        If numba cannot compile the law, or it does what its record does not state: jumps, creates
        energy, unloads from another force, leaves a dent below zero, or does not begin as Hertz's.

    Examples
    --------
    >>> def curve(delta, E, R, S_y, nu):
    ...     K = 4.0 / 3.0 * E * R**0.5
    ...     return K * delta**1.5, K, 0.0, 1.5
    >>> law = il.register(il.ContactLaw(name="elastic", curve=curve))
    contact law 'elastic', source hash ...
    >>> il.paper_impact(1.0, law).contact
    'elastic'
    """
    instance("register", "law", law, ContactLaw)
    reasons = refusals(law)
    numbers = [] if impossible(law) else lines(law)
    print(f"contact law {law.name!r}, source hash {law.source_hash}, from {law.provenance}")
    print("numbers of its record, for steel, that differ from the defaults:")
    print(*(f"    {line}" for line in numbers or ["(none)"]), sep="\n")
    if reasons:
        raise ValueError(
            f"contact law {law.name!r}: {'; '.join(reasons)}. Correct it, or state in "
            "il.ContactLaw what it does, with the numbers printed above"
        )
    adopt(law)
    return law
