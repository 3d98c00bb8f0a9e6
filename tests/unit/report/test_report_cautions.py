"""Cautions and notes: each where it matters, and only there."""

import re

import numpy as np
import xarray as xr

from impactlab.report.cautions import beside, cautions, endings, notes
from impactlab.solver.contact import CONTACT_LAWS, LAWS
from impactlab.variables import WARNINGS


def _said(texts, words):
    return any(words in text for text in texts)


def test_plastic_strain_without_a_convergence_study(material_study):
    runs, analysis = material_study
    words = "depends on the number of nodes, which this study does not vary"
    assert beside(runs, analysis, "peak_plastic_strain") == words
    assert beside(runs, analysis, "peak_force") == ""
    hardening = runs.isel(beam_isotropic_hardening_modulus=slice(1, None))
    assert beside(hardening, analysis, "peak_plastic_strain") == words
    elastic = runs.assign(peak_plastic_strain=0.0 * runs["peak_plastic_strain"])
    assert beside(elastic, analysis, "peak_plastic_strain") == ""


def test_a_verdict_of_its_own_takes_the_place(discretisation_study):
    assert beside(*discretisation_study, "peak_plastic_strain") == ""


def test_energy_imbalance_and_restitution_above_one(material_study, report):
    runs, analysis = material_study
    assert beside(runs, analysis, "energy_error") == beside(runs, analysis, "restitution") == ""
    runs["energy_error"][0, 0, :] = 0.02
    runs["restitution"][1, 0, 0] = 1.05
    assert beside(runs, analysis, "energy_error") == "above 0.001 in 2 runs"
    assert beside(runs, analysis, "restitution") == "above 1 in 1 run"
    # a doubt stands beside its number in the answer and in the table
    runs["restitution"][1, 0, 0] = 1.05
    page = report(runs, analysis)
    assert re.search(r"Doubtful: [^.]*restitution \(above 1 in 1 run\)", page.text)
    rows = page.tables["Range of each response"]
    assert next(row for row in rows if row[0].startswith("Restitution"))[0].endswith(
        "; above 1 in 1 run"
    )
    assert page.text.count("above 1 in 1 run") == 2


def test_a_run_that_lacks_a_response_has_not_failed(velocity_study, failing):
    runs, _ = velocity_study
    assert endings(runs) == ""
    runs["restitution"][0, 0] = np.nan
    assert endings(runs) == "1 without an answer"
    assert endings(failing(runs, {"velocity": 5})) == "2 failed, 1 without an answer"


def test_a_study_without_trouble_has_no_caution(material_study):
    runs, _ = material_study
    assert list(cautions(runs)) == []
    # inputs outside the data of the contact law stand beside its responses
    runs, analysis = material_study
    assert beside(runs, analysis, "peak_force") == ""
    runs["remarks"] = xr.zeros_like(runs["status"])
    runs["remarks"][0, :, 0] = WARNINGS["hardening_outside_data"][0]
    assert "outside the contact law's data in 3 runs" in beside(runs, analysis, "peak_force")
    assert _said(cautions(runs), "In 3 of 24 runs the beam's hardening modulus is above")
    # runs whose contact law created energy are counted
    runs, _ = material_study
    words = "the contact law created energy"
    assert not _said(cautions(runs), words)
    runs["remarks"] = xr.zeros_like(runs["status"])
    assert not _said(cautions(runs), words)
    runs["remarks"][0, :, 0] = 1
    assert _said(cautions(runs), f"In 3 of 24 runs {words}")


def test_notes_on_the_contact_law(velocity_study):
    runs, _ = velocity_study
    words = "creates energy"
    assert _said(notes(runs), words)
    assert not _said(notes(runs.sel(contact=["hertz"])), words)
    assert _said(notes(runs.sel(contact="stronge")), words)
    # notes on responses
    kept = runs.sel(contact=["hertz"])
    assert _said(notes(kept[["contact_duration"]]), "that of the first contact")
    assert _said(notes(kept[["restitution"]]), "last contact within the simulated time")
    assert _said(notes(kept[["peak_plastic_strain"]]), "does not converge")
    assert list(notes(kept[["peak_force"]])) == []
    # note on the modal scheme
    words = "The modal scheme"
    assert not _said(notes(runs.assign_coords(scheme="leapfrog")), words)
    assert _said(notes(runs.assign_coords(scheme="modal")), words)
    varied = runs.expand_dims(scheme=["leapfrog", "modal"])
    assert _said(notes(varied), words)


def test_notes_say_what_of_a_law_is_not_confirmed(laws_study):
    runs, _ = laws_study
    doubted = [law for law in LAWS if CONTACT_LAWS[law].unconfirmed]
    assert sum(law in doubted for law in LAWS[:8]) == 6
    for law in doubted:
        said = [text for text in notes(runs.sel(contact=[law])) if f"“{law}”" in text]
        assert len(said) == 1
        assert f"The following is not confirmed: {CONTACT_LAWS[law].unconfirmed}." in said[0]
    assert not _said(notes(runs.sel(contact=["hertz", "stronge"])), "not confirmed")


def test_notes_on_few_lobatto_points(discretisation_study):
    runs, _ = discretisation_study
    words = "Few Lobatto points"
    assert _said(notes(runs), words)
    assert not _said(notes(runs.sel(points=[5, 9])), words)
    assert not _said(notes(runs.sel(rule=["layers"])), words)
    # no note applies to nothing
    assert list(notes(xr.Dataset())) == []
