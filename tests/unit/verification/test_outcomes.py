from dataclasses import asdict, replace

import numpy as np

from impactlab.files import read_netcdf, write_netcdf
from impactlab.verification.finding import gravest_first
from impactlab.verification.outcomes import packed, unpacked


def kept(dataset, tmp_path):
    write_netcdf(dataset, tmp_path / "findings.nc", "findings")
    return read_netcdf(tmp_path / "findings.nc", "findings")


def same(first, second):
    np.testing.assert_equal([asdict(entry) for entry in first], [asdict(entry) for entry in second])


def test_outcomes_come_back_from_the_file_in_any_order(outcomes, tmp_path):
    for order in (outcomes, gravest_first(outcomes)):
        same(unpacked(kept(packed(order), tmp_path)), [tidy(entry) for entry in order])


def test_checks_without_comparisons_or_curves_come_back(outcomes, tmp_path):
    """Without a row there are no values to take a type from."""
    few = [entry for entry in outcomes if not entry.finding.comparisons]
    same(unpacked(kept(packed(few), tmp_path)), [tidy(entry) for entry in few])
    assert unpacked(kept(packed([]), tmp_path)) == []


def test_comparisons_are_a_labelled_table(outcomes, tmp_path):
    stored = kept(packed(outcomes), tmp_path)
    assert stored.sizes["comparison"] == 21
    row = stored.isel(comparison=1)
    assert (row["check"].item(), row["quantity"].item(), row["where"].item()) == (
        "good",
        "deflection",
        "at 1 m/s",
    )
    assert (row.units.item(), row.measure.item(), row.passed.item()) == ("m", "absolute", True)
    assert row.ours.item() == 1.2003e-3
    assert stored["uncertainty"].values[:2].tolist() == [1e-14, 1.2e-17]
    assert stored["reference"].sel(name="good").item() == "closed form"
    assert int((~stored.passed).sum()) == 3
    assert stored.verdict.sel(name="broken").item() == "error"
    assert all("long_name" in stored[name].attrs for name in stored.data_vars)


def test_findings_of_an_earlier_version_have_unknown_uncertainties(outcomes):
    older = packed(outcomes).drop_vars(["uncertainty", "reference", "basis"])
    first = unpacked(older)[0]
    assert (first.reference, first.basis) == ("", "")
    assert np.isnan(first.finding.comparisons[0].uncertainty)


def tidy(outcome):
    """Sequences as lists: what they were is not kept."""
    finding = outcome.finding
    panels = [
        type(panel)(panel.title, panel.x, panel.y, list(panel.curves), panel.log)
        for panel in finding.panels
    ]
    tidied = type(finding)(list(finding.comparisons), panels)
    return replace(outcome, finding=tidied)
