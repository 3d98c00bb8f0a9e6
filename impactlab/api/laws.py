"""Registration of laws from outside the package."""

from impactlab.model.checks import require
from impactlab.model.contact_law import ContactLaw
from impactlab.model.flow_law import FlowLaw
from impactlab.model.own_law import OwnLaw, adopt
from impactlab.verification import law_record


def register(law: ContactLaw | FlowLaw) -> ContactLaw | FlowLaw:
    """Check a law of one's own, print its numbers, and let studies use it.

    Registered again under the same name, a law takes the earlier one's place; stored answers are
    kept apart by the hashes of the sources.

    Parameters
    ----------
    law : ContactLaw or FlowLaw
        Law.

    Returns
    -------
    ContactLaw or FlowLaw
        The same law.

    Raises
    ------
    ValueError
        If numba cannot compile the law. A contact law is refused if it does what its record does
        not state: jumps, creates energy, unloads from another force, leaves a dent below zero, or
        does not begin as Hertz's; a flow law if its stress does not begin at the yield stress, or
        falls with plastic strain or rate.

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
    require(isinstance(law, OwnLaw), "register", "law", law, "must be a ContactLaw or a FlowLaw")
    if isinstance(law, FlowLaw):
        reasons, numbers = law_record.flow_refusals(law), law_record.flow_lines(law)
        heading, advice = "for steel:", "Correct it"
    else:
        reasons = law_record.refusals(law)
        numbers = [] if law_record.impossible(law) else law_record.lines(law)
        heading = "numbers of its record, for steel, that differ from the defaults:"
        advice = (
            "Correct it, or state in il.ContactLaw what it does, with the numbers printed above"
        )
    print(f"{law.kind} {law.name!r}, source hash {law.source_hash}, from {law.provenance}")
    print(heading)
    print(*(f"    {line}" for line in numbers or ["(none)"]), sep="\n")
    if reasons:
        raise ValueError(f"{law.kind} {law.name!r}: {'; '.join(reasons)}. {advice}")
    adopt(law)
    return law
