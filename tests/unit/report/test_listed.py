"""The report of a 3-D run, and its entry in the index."""

import json
from types import SimpleNamespace

from made_solid import beam_models, solid

from impactlab.fem3d.comparison import compared
from impactlab.fem3d.plan import case_of
from impactlab.fem3d.report import write_comparison
from impactlab.report.results import write_index


def test_the_closest_model_is_named_and_the_index_lists_the_report(tmp_path, page):
    folder = tmp_path / "results" / "paper" / "witness"
    folder.mkdir(parents=True)
    plan = SimpleNamespace(case=case_of(None), element_size=2e-3, patch=1e-3, duration=4.5e-4)
    made = solid().assign(number_of_elements=1234, maximum_indentation=7e-5)
    beams = beam_models()
    beams["peak_force"] = beams["peak_force"].copy(data=[12.1e3, 11.11e3, 22e3])
    responses = compared(made, beams)
    write_comparison(responses, made, plan, folder / "figures", folder / "report.html")
    report = page((folder / "report.html").read_text("utf-8"))
    assert "The Timoshenko model is closest to the 3-D FE model: peak force +1 %" in report.text
    assert "Euler-Bernoulli: peak force +10 %" in report.text
    assert "1,234 elements, 3 beam models" in report.text
    rows = {row[0]: row for row in report.tables[next(iter(report.tables))]}
    assert rows["Peak force"][1:3] == ["kN", "11"]
    assert rows["Peak force"][3].startswith("12.1")
    assert rows["Peak force"][3].endswith("+10 %")
    assert "impactlab witness --velocity" in report.text
    assert "../../index.html" in {attrs["href"] for attrs in report.named("a")}

    def listed():
        write_index(tmp_path / "results", tmp_path / "results" / "index.html")
        index = page((tmp_path / "results" / "index.html").read_text("utf-8"))
        return {attrs["href"] for attrs in index.named("a")}

    assert listed() == {"#main", "paper/witness/report.html"}
    entry = folder / "report.index.json"
    stored = json.loads(entry.read_text("utf-8"))
    for damaged in ("[]", "{", json.dumps({"title": "alone"}), json.dumps(stored | {"report": 1})):
        entry.write_text(damaged)
        assert listed() == {"#main"}
    entry.write_text(json.dumps(stored))
    (folder / "report.html").unlink()
    assert listed() == {"#main"}
