"""Contact laws from outside: the same answers as built-in ones, keyed by their source, and told."""

import pickle
import subprocess
import sys
from dataclasses import replace
from textwrap import dedent

import numpy as np
import pytest

import impactlab as il
from impactlab.model import contact_law
from impactlab.report.cautions import notes
from impactlab.solver.contact import CONTACT_LAWS, LAWS, NUMBERED
from impactlab.study.solvers import kernels

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")

GRID = il.Discretisation(nodes=21, points=3)
FACTOR, ALPHA = 4.0 / 3.0, 0.08


def stiffness(E, R):
    return FACTOR * E * np.sqrt(R)


def hertz(delta, E, R, S_y, nu):
    K = stiffness(E, R)
    return K * delta * np.sqrt(delta), K, 0.0, 1.5


def damping(F, delta, rate, E, R, S_y, nu):
    return 1.5 * ALPHA * rate * F


@pytest.fixture(autouse=True)
def _session():
    """Forget the laws of each test."""
    yield
    for name in [name for name in CONTACT_LAWS if name not in LAWS]:
        del CONTACT_LAWS[name]
    NUMBERED.clear()


def strong(factor):
    """Return Hertz's law with another stiffness: equal but for a variable around the function."""

    def curve(delta, E, R, S_y, nu):
        K = factor * stiffness(E, R)
        return K * delta * np.sqrt(delta), K, 0.0, 1.5

    return curve


def own(curve=hertz, name="own", **stated):
    return il.ContactLaw(name=name, curve=curve, **stated)


def answers(contact):
    """Return two answers of a lumped beam, whose kernel compiles soonest."""
    impact = replace(il.paper_impact(1.0, contact), beam_model="spring_mass")
    run = il.simulate(impact, duration=1e-3, samples=2)
    assert run.contact.attrs.get("origin", "").endswith(getattr(contact, "source_hash", ""))
    return run.peak_force.item(), run.restitution.item()


@pytest.mark.long
def test_answers_are_those_of_the_built_in_law_and_of_the_present_source(capsys):
    law = il.register(own(strong(1.0), damping=damping))
    assert answers(law) == pytest.approx(answers("hunt_crossley"), rel=1e-9)
    # a law of the same name and code, with another constant, in the same session
    softer = il.register(own(strong(0.5), damping=damping, hertzian_start=False))
    assert softer.number != law.number
    assert answers(softer)[0] < 0.95 * answers("hunt_crossley")[0]
    with pytest.raises(ValueError, match="is not registered"):
        il.paper_impact(1.0, law)


def test_the_hash_is_of_all_that_a_law_uses():
    def by(helper):
        def curve(delta, E, R, S_y, nu):
            return helper(delta, E, R), stiffness(E, R), 0.0, 1.5

        return curve

    laws = [
        own(),
        own(strong(1.0)),
        own(strong(0.5)),
        own(by(lambda delta, E, R: stiffness(E, R) * delta**1.5)),
        own(by(lambda delta, E, R: stiffness(E, R) * delta**1.4)),
        own(limit=lambda E, R, S_y, nu: 0.5 * R),
        own(damping=damping),
    ]
    assert len({law.number for law in laws}) == len(laws)
    assert own(strong(0.5)).source_hash == laws[2].source_hash  # of the source, not of the object
    assert all(law.number == int(float(law.number)) for law in laws)  # exact in columns of floats


def test_a_law_keeps_the_constants_that_it_was_made_with(monkeypatch):
    law = own()
    monkeypatch.setitem(globals(), "FACTOR", 100.0)
    assert law.curve(1e-5, 1e9, 0.1, 1e6, 0.3)[1] == pytest.approx(4.0 / 3.0 * 1e9 * 0.1**0.5)
    assert own().source_hash != law.source_hash


def test_a_law_travels_by_value():
    law = own(damping=damping, flaws="none known")
    sent = pickle.loads(pickle.dumps(law))
    assert (sent.source_hash, sent.provenance, sent.flaws) == (
        law.source_hash,
        law.provenance,
        "none known",
    )
    rebuild, (kind, packed, _, origin) = law.__reduce__()
    with pytest.raises(RuntimeError, match="arrived with another source"):
        rebuild(kind, packed, "0" * 16, origin)


def creating(delta, E, R, S_y, nu):
    K = stiffness(E, R)
    return K * delta**1.5, 1.2 * K, 0.0, 1.5


def jumping(delta, E, R, S_y, nu):
    K = stiffness(E, R) * (1.0 if delta < 1e-4 else 1.5)
    return K * delta**1.5, K, 0.0, 1.5


def linear(delta, E, R, S_y, nu):
    return E * R * delta, E * R, 0.0, 1.0


def negative(delta, E, R, S_y, nu):
    return -stiffness(E, R) * delta**1.5, stiffness(E, R), 0.0, 1.5


def driven(F, delta, rate, E, R, S_y, nu):
    return -0.1 * rate * F


def forced(F, delta, rate, E, R, S_y, nu):
    return 0.1 * F


@pytest.mark.parametrize(
    ("law", "message"),
    [
        (own(creating), "it creates energy: the coefficient of restitution is up to 1.0954"),
        (own(jumping), "its loading force jumps"),
        (own(linear), "state hertzian_start=False"),
        (own(negative), "forces that are not finite and above zero"),
        (own(damping=driven), "damping creates energy"),
        (own(damping=forced), "damping is not zero at rest"),
        (own(lambda delta, E, R, S_y, nu: delta), "expected \\(F, K, delta_r, n\\)"),
        (own(lambda delta, E, R, S_y, nu: {}.get(delta, "x")), "numba cannot compile curve"),
    ],
)
def test_registration_refuses_what_the_record_does_not_state(law, message):
    with pytest.raises(ValueError, match=message):
        il.register(law)
    assert "own" not in CONTACT_LAWS


def test_the_printed_numbers_make_the_record_whole(capsys):
    with pytest.raises(ValueError, match="with the numbers printed above"):
        il.register(own(creating))
    lines = [line for line in capsys.readouterr().out.splitlines() if line.startswith("    ")]
    stated = eval(f"dict({''.join(lines)})")
    il.register(own(creating, **stated, flaws="It creates energy at any indentation."))
    assert CONTACT_LAWS["own"].restitution == pytest.approx(1.2**0.5, rel=1e-4)


@pytest.mark.parametrize(
    ("stated", "message"),
    [
        ({"name": "hertz"}, "is that of a built-in law"),
        ({"name": "My law"}, "must be small letters"),
        ({"curve": lambda delta, E: 0.0}, r"expected \(delta, E, R, S_y, nu\)"),
        ({"curve": 3.0}, "is of type float: expected a Python function"),
        ({"limit": lambda E, R, S_y, nu: GRID}, "uses the global GRID, which is of type"),
    ],
)
def test_laws_that_cannot_be(stated, message):
    with pytest.raises(ValueError, match=message):
        il.ContactLaw(**{"name": "own", "curve": hertz} | stated)


def test_datasets_and_reports_name_law_and_hash(capsys):
    law = il.register(own(title="A law of mine"))
    sampling = il.Grid(parameters={"velocity": [1.0, 2.0], "contact": ["hertz", "own"]})
    study = il.Study(
        title="Two laws",
        impact=il.paper_impact(),
        discretisation=GRID,
        duration="1 ms",
        sampling=sampling,
        responses=["peak_force"],
    )
    design = study.design()
    assert law.source_hash in design.contact.attrs["origin"]
    kernels.check_laws(design)
    del CONTACT_LAWS["own"]
    with pytest.raises(ValueError, match=f"{law.source_hash}, but this session does not know it"):
        kernels.check_laws(design)
    # a later session reads the report without the law
    (note,) = [text for text in notes(design) if "“own”" in text]
    assert f"source hash {law.source_hash}" in note
    assert "A law of mine" in note
    il.register(own(strong(1.0)))
    with pytest.raises(ValueError, match="has another one, source hash"):
        kernels.check_laws(design)


def test_an_entry_point_of_another_package(tmp_path):
    """A tiny package, found by its metadata, in a session of its own."""
    (tmp_path / "bouncy.py").write_text(
        dedent("""
        import math
        import impactlab as il

        def curve(delta, E, R, S_y, nu):
            K = 4.0 / 3.0 * E * math.sqrt(R)
            return K * delta**1.5, K, 0.0, 1.5

        law = il.ContactLaw(name="bouncy", curve=curve)
        """)
    )
    metadata = tmp_path / "bouncy-1.2.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: bouncy\nVersion: 1.2\n")
    (metadata / "entry_points.txt").write_text(f"[{contact_law.GROUP}]\nbouncy = bouncy:law\n")
    program = f"""
import sys; sys.path.insert(0, {str(tmp_path)!r})
import impactlab as il
from impactlab.solver.contact import CONTACT_LAWS
print(il.paper_impact(1.0, "bouncy").contact, CONTACT_LAWS["bouncy"].provenance)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.stdout.strip() == "bouncy bouncy 1.2, entry point bouncy:law", done.stderr
