"""The table of variables, and where numbers say they come from."""

import re
import subprocess
from datetime import UTC, datetime, timedelta
from importlib.metadata import version

import numpy as np
import pytest
import xarray as xr

import impactlab as il
from impactlab import provenance as source
from impactlab.model.parameters import PARAMETERS
from impactlab.provenance import provenance
from impactlab.solver.contact import CONTACT_LAWS
from impactlab.variables import (
    BY_SPHERE,
    COORDINATES,
    FAILED,
    FAILURES,
    FIELDS,
    HISTORIES,
    MARKED,
    MARKS,
    OF_STRIKES,
    PROFILES,
    RESPONSES,
    SCALARS,
    STATUS_FLAGS,
    WARNINGS,
    attributes,
    described,
    reasons,
    status_bits,
)

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")

TABLE = (
    RESPONSES | HISTORIES | PROFILES | FIELDS | OF_STRIKES | BY_SPHERE | COORDINATES | PARAMETERS
)
BITS = {name: bit for name, (bit, _) in STATUS_FLAGS.items()}
WHOLE_RUN = {"diverged", "energy_out_of_balance", "earlier_strike_unfinished", "stopped"}


@pytest.mark.parametrize("name", TABLE)
def test_units_are_udunits_and_names_are_spelled_out(name):
    attrs = attributes(name)
    assert re.fullmatch(r"1|[A-Za-z]+(-?\d)?( [A-Za-z]+(-?\d)?)*", attrs["units"])
    assert len(attrs["long_name"]) > 4
    assert TABLE[name].name == name


def test_no_name_is_used_twice():
    tables = (
        RESPONSES,
        HISTORIES,
        PROFILES,
        FIELDS,
        OF_STRIKES,
        BY_SPHERE,
        COORDINATES,
        PARAMETERS,
    )
    assert sum(map(len, tables)) == len(TABLE)
    # an unknown variable is an error
    with pytest.raises(KeyError, match="contact_farce"):
        attributes("contact_farce")
    # responses name the flags that make them missing
    for name, entry in SCALARS.items():
        named = set(attributes(name).get("missing_because", "").split())
        assert named == ({*WHOLE_RUN, entry.missing} if entry.missing else set())
        assert named <= set(STATUS_FLAGS)


@pytest.mark.parametrize(("name", "flags"), [("status", STATUS_FLAGS), ("remarks", WARNINGS)])
def test_bits_are_cf_flags(name, flags):
    attrs = attributes(name)
    assert attrs["flag_meanings"].split() == list(flags)
    assert attrs["flag_masks"].tolist() == [bit for bit, _ in flags.values()]
    assert attrs["flag_masks"].dtype == np.int32


def test_described_fills_in_what_is_known_and_keeps_what_was_said():
    data = xr.Dataset(
        {"peak_force": 1.0, "own": ("run", [1.0])},
        coords={"velocity": ("run", [2.0], {"long_name": "mine", "low": 1.0})},
    )
    result = described(data)
    assert result.peak_force.attrs == attributes("peak_force")
    assert result.velocity.attrs == {"units": "m s-1", "long_name": "mine", "low": 1.0}
    assert result.own.attrs == {}


def test_status_bits_are_those_that_matter_to_the_asked_responses():
    whole = sum(BITS[name] for name in WHOLE_RUN)
    assert status_bits([]) == whole
    assert status_bits(["energy_error"]) == whole
    assert status_bits(["contact_duration"]) == whole | BITS["first_contact_unfinished"]
    assert status_bits(SCALARS) == FAILED == sum(bit for bit, _ in FAILURES.values())
    assert status_bits(RESPONSES) | BITS["not_steady"] | BITS["no_shakedown"] == FAILED
    assert status_bits(RESPONSES) & (BITS["not_steady"] | BITS["no_shakedown"]) == 0
    assert sum(BITS.values()) == FAILED | MARKED
    assert BITS["outside_contact_law"] == MARKED
    assert status_bits(["output of a test function"]) == whole


def test_status_of_a_run_is_zero_where_every_asked_response_is_there():
    """Too short for a rebound, long enough for a peak."""
    asked = {"peak_force": 0, "restitution": BITS["sphere_not_leaving"]}
    run = il.simulate(
        il.paper_impact(), il.Discretisation(nodes=21, points=3), duration=1.8e-4, samples=2
    )
    for name, bits in asked.items():
        assert run.status.item() & status_bits([name]) == bits
        assert np.isnan(run[name].item()) == (bits > 0)


def test_reasons_are_words():
    assert reasons(0) == []
    two = BITS["diverged"] | BITS["in_contact_at_end"]
    assert reasons(two, MARKS) == []
    assert reasons(two | BITS["outside_contact_law"]) == [
        STATUS_FLAGS["diverged"][1],
        STATUS_FLAGS["in_contact_at_end"][1],
    ]
    # failures and marks are told apart
    assert not set(FAILURES) & set(MARKS)
    assert reasons(BITS["outside_contact_law"], MARKS) == [MARKS["outside_contact_law"][1]]
    assert reasons(BITS["outside_contact_law"]) == []


def test_contact_says_where_its_laws_come_from_and_what_is_in_doubt():
    many = il.simulate_many(
        il.paper_impact(),
        il.Discretisation(nodes=11, points=3),
        duration=1e-5,
        varied={"contact": ["mjg", "hertz", "mjg"]},
    )
    attrs = many.contact.attrs
    assert attrs["long_name"] == "contact law"
    assert attrs["source"].splitlines() == [
        f"{law}: {CONTACT_LAWS[law].source}" for law in ("hertz", "mjg")
    ]
    assert attrs["unconfirmed"] == f"mjg: {CONTACT_LAWS['mjg'].unconfirmed}"
    assert "flaws" not in described(xr.Dataset({"contact": "hertz"})).contact.attrs


def test_provenance_names_versions_time_and_machine():
    found = provenance()
    made = datetime.fromisoformat(found["created"])
    assert abs(datetime.now(UTC) - made) < timedelta(minutes=1)
    for name in ("impactlab", "numpy", "numba", "xarray"):
        assert f"{name} {version(name)}" in found["versions"]
    assert re.search(r"python 3\.\d+\.\d+$", found["versions"])
    assert re.search(r", \d+ cores$", found["processor"])
    assert found["Conventions"].startswith("CF-")


@pytest.fixture
def source_tree(tmp_path, monkeypatch):
    """The package as if it lay in a folder of its own."""
    monkeypatch.setattr(source, "__file__", str(tmp_path / "impactlab" / "variables.py"))
    (tmp_path / "impactlab").mkdir()
    return tmp_path


def git(folder, *words):
    settings = ["-c", "user.name=a", "-c", "user.email=a@b", "-c", "commit.gpgsign=false"]
    command = ["git", "-C", str(folder), *settings, *words]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


def test_source_revision_is_the_commit_and_says_when_the_tree_differs(source_tree):
    git(source_tree, "init")
    file = source_tree / "impactlab" / "variables.py"
    file.write_text("one")
    git(source_tree, "add", ".")
    git(source_tree, "commit", "-m", "one")
    commit = git(source_tree, "rev-parse", "HEAD")[:12]
    assert provenance()["source_revision"] == commit
    file.write_text("another")
    assert provenance()["source_revision"] == commit  # what this process has loaded
    source._of_this_process.cache_clear()
    assert provenance()["source_revision"] == f"{commit}-dirty"


def test_source_revision_outside_a_checkout_is_the_release(source_tree):
    assert provenance()["source_revision"] == f"release {version('impactlab')}"


def test_source_revision_of_a_broken_checkout_is_unknown(source_tree):
    (source_tree / ".git").mkdir()
    assert provenance()["source_revision"].startswith("unknown")
