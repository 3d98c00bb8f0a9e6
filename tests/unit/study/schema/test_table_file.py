"""Studies of a table in a CSV file."""

import csv
import re

import numpy as np
import pytest

import impactlab as il
from impactlab.cli import results, solve
from impactlab.files import read_netcdf
from impactlab.study.schema.readers import describe, read_any, read_study
from impactlab.study.schema.table_file import runs_of_file
from impactlab.study.schema.yaml_file import read_mapping
from impactlab.validation.errors import StudyError

ROWS = 500
TEXT = """\
title: Drop tests
table: drops.csv
inputs:
  speed: {units: m/s, distribution: uniform, low: 1 m/s, high: 5 m/s}
  gap: mm
  metal:
outputs:
  force: {column: "force (kN)", units: kN}
  dent: um
indices: [delta, pawn]
seed: 3
"""


@pytest.fixture
def columns():
    rng = np.random.default_rng(1)
    speed, gap = rng.uniform(1, 5, ROWS), rng.normal(3, 0.5, ROWS)
    metal = rng.choice(["steel", "brass"], ROWS)
    force = 2 * speed + (metal == "steel")
    dent = np.where(np.arange(ROWS) == 4, np.nan, 10 * speed)
    return {"speed": speed, "gap": gap, "metal": metal, "force (kN)": force, "dent": dent}


def _written(folder, columns, text=TEXT, **options):
    """Write a study and its table; return the path of the study."""
    (folder / "studies").mkdir(exist_ok=True)
    with (folder / "studies" / "drops.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, **options)
        writer.writerow(columns)
        for row in zip(*columns.values(), strict=True):
            writer.writerow("" if cell != cell else cell for cell in row)
    path = folder / "studies" / "drops.yaml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
def test_a_file_gives_the_bits_of_python_in_si_units(tmp_path, columns, delimiter):
    runs = runs_of_file(read_any(_written(tmp_path, columns, delimiter=delimiter)))
    inputs = {name: columns[name] for name in ("speed", "gap", "metal")}
    outputs = {"force": columns["force (kN)"], "dent": columns["dent"]}
    plain = il.runs_of_table(inputs, outputs, indices=["delta", "pawn"], seed=3)
    for name, factor in {"speed": 1, "gap": 1e-3, "force": 1e3, "dent": 1e-6}.items():
        np.testing.assert_allclose(runs[name], factor * plain[name], rtol=1e-15)
    for name in ("run", "row", "speed", "metal"):
        np.testing.assert_array_equal(runs[name], plain[name])
    units = {name: runs[name].attrs["units"] for name in ("speed", "gap", "force", "dent")}
    assert units == {"speed": "m s-1", "gap": "m", "force": "N", "dent": "m"}
    assert runs["speed"].attrs["distribution"] == "uniform"
    assert runs["speed"].attrs["high"] == 5.0


def test_indices_without_units_are_those_of_python_to_the_last_bit(tmp_path, columns):
    text = re.sub(r"(gap|dent): \w+", r"\1:", TEXT).replace(", units: kN", "")
    text = text.replace("{units: m/s, distribution: uniform, low: 1 m/s, high: 5 m/s}", "")
    text = text.replace("delta, pawn", "pawn")
    found = il.analyse(runs_of_file(read_any(_written(tmp_path, columns, text))))
    inputs = {name: columns[name] for name in ("speed", "gap", "metal")}
    outputs = {"force": columns["force (kN)"], "dent": columns["dent"]}
    plain = il.runs_of_table(inputs, outputs, indices="pawn", seed=3, title="drops")
    expected = il.analyse(plain)
    for name in expected.data_vars:
        np.testing.assert_array_equal(found[name], expected[name], err_msg=str(name))


def test_go_gives_results_and_a_report_that_speaks_of_rows(
    tmp_path, columns, monkeypatch, capsys, blank_pictures
):
    columns["dent"][:] = 5 * columns["speed"] + columns["gap"]
    columns["dent"][4] = np.nan
    text = TEXT.replace("[delta, pawn]", "[rbd_fast]").replace("  metal:\n", "")
    path = _written(tmp_path, columns, text)
    monkeypatch.chdir(tmp_path)
    for only in ("solve", "report"):
        solve.go(path.relative_to(tmp_path), workers=1, only=only)
    said = capsys.readouterr().out
    assert re.search(r"speed \([\d.]+ ± [\d.]+ %\) explains most of the variance", said)
    assert "of the force in this table" in said
    folder = tmp_path / "results" / "drops"
    page = re.sub(r"<[^>]+>", " ", (folder / "report.html").read_text(encoding="utf-8"))
    for words in (
        "1 without an answer",
        "row 5, speed",
        "the table has no value there",
        "500 rows",
    ):
        assert words in re.sub(r"\s+", " ", page)
    assert not re.search(r"scatter of|What was varied|\d+ draws", page)
    assert read_netcdf(folder / "runs.nc", "runs").attrs["table"] == "drops.csv"
    results.export("drops", output=folder / "tables")
    assert describe(path.relative_to(tmp_path)) == {
        "name": "drops",
        "title": "Drop tests",
        "size": "table drops.csv",
        "traits": ["table"],
        "table": "studies/drops.csv",
    }


def test_a_limit_in_its_unit_gives_target_indices(tmp_path, columns, validator):
    text = TEXT.replace("[delta, pawn]", "[target_hsic]\nlimits: {force: 6.5 kN}")
    columns = {name: values[:150] for name, values in columns.items()}
    path = _written(tmp_path, columns, text)
    indices = il.analyse(runs_of_file(read_any(path)))["target_hsic"]
    inputs = {name: columns[name] for name in ("speed", "gap", "metal")}
    above = {"force": (columns["force (kN)"] > 6.5) * 1.0}
    options = {"indices": "target_hsic", "seed": 3, "limits": {"force": 0.5}}
    plain = il.analyse(il.runs_of_table(inputs, above, **options))["target_hsic"]
    np.testing.assert_allclose(indices.sel(response="force"), plain[0], rtol=1e-6)
    assert indices.sel(response="force")[0] > 0.3
    assert np.isnan(indices.sel(response="dent")).all()
    assert validator.is_valid(read_mapping(text, str(path)))


def test_a_choice_makes_words_of_numbers(tmp_path, columns):
    columns["metal"] = np.where(columns["metal"] == "steel", "1", "2")
    words = "metal: {distribution: choice, values: ['2', '1'], weights: [1, 3]}"
    runs = runs_of_file(read_any(_written(tmp_path, columns, TEXT.replace("metal:", words))))
    assert runs["metal"].dtype.kind == "U"
    assert runs["metal"].attrs["values"] == ["2", "1"]
    assert runs["metal"].attrs["weights"] == [0.25, 0.75]
    columns["metal"][3] = "3"
    with pytest.raises(StudyError, match="line 5, metal = '3': unknown word"):
        runs_of_file(read_any(_written(tmp_path, columns, TEXT.replace("metal:", words))))
    absent = words.replace("'1'", "'1', '3', '4'").replace("[1, 3]", "[1, 3, 1, 1]")
    with pytest.raises(StudyError, match=r"inputs\.metal\.values: no row holds '4'"):
        runs_of_file(read_any(_written(tmp_path, columns, TEXT.replace("metal:", absent))))


def _edited(columns, name, row, cell):
    edited = {key: list(values) for key, values in columns.items()}
    edited[name][row] = cell
    return edited


CELLS = {
    "word among numbers": ("gap", "soft", "line 8, gap: 'soft' is no finite number"),
    "comma": ("gap", "3,5", "line 8, gap: '3,5' is no finite number: write 3.5"),
    "infinity": ("dent", "inf", "line 8, dent: 'inf' is no finite number"),
    "missing input": ("speed", "NaN", "line 8, speed: is empty, and an input has a value"),
    "missing word": ("metal", "", "line 8, metal: is empty"),
    "outside": ("speed", "5.5", "line 8, speed: 5.5 m/s is outside the distribution"),
    "number among words": ("metal", "3", "line 2, metal: '(steel|brass)' is no finite number"),
}


@pytest.mark.parametrize("case", CELLS)
def test_a_wrong_cell_is_named_by_line_and_column(tmp_path, columns, case):
    name, cell, words = CELLS[case]
    study = read_any(_written(tmp_path, _edited(columns, name, 6, cell)))
    with pytest.raises(StudyError, match=rf"drops\.csv: {words}"):
        runs_of_file(study)


CONTENTS = {
    "nothing": ("", "is empty: give heads, and a row per run"),
    "blank": ("\n , \n", "is empty"),
    "heads": ("speed,gap,metal,force (kN),dent\n", "has a line of heads and no rows"),
    "twice": ("speed,gap,speed\n1,2,3\n", "has two columns 'speed'"),
    "ragged": ("speed,gap\n1,2\n3\n", "line 3: has 1 cells, and the heads are 2"),
    "quotation": ('speed,gap\n1,"2\n', "line 2: unexpected end of data"),
    "column": ("speed,gap,metals,force,dent\n1,2,x,3,4\n", "inputs.metal: unknown column"),
}


@pytest.mark.parametrize("case", CONTENTS)
def test_a_wrong_table_is_refused_in_words(tmp_path, columns, case):
    content, words = CONTENTS[case]
    study = read_any(_written(tmp_path, columns))
    study.csv.write_text(content, encoding="utf-8")
    with pytest.raises(StudyError, match=re.escape(words)):
        runs_of_file(study)


def test_a_table_that_is_missing_or_short_or_no_text_is_refused(tmp_path, columns):
    study = read_any(_written(tmp_path, {name: values[:50] for name, values in columns.items()}))
    with pytest.raises(StudyError, match="50 rows are too few for delta: give 64 or more"):
        runs_of_file(study)
    study.csv.write_bytes(b"speed\n\xff\n")
    with pytest.raises(StudyError, match="is not text in UTF-8"):
        runs_of_file(study)
    study.csv.unlink()
    with pytest.raises(StudyError, match="cannot be read: No such file"):
        runs_of_file(study)


TEXTS = {
    "unit": ("gap: mm", "gap: mmm", "inputs.gap.units: unknown unit 'mmm': write one"),
    "distribution": ("uniform", "unifrom", "inputs.speed.distribution = 'unifrom': unknown"),
    "ends": ("high: 5 m/s", "high: 0.5 m/s", r"inputs.speed.high .*must be above low"),
    "dimension": ("high: 5 m/s", "high: 5 mm", "inputs.speed.high = '5 mm'.*wrong dimension"),
    "key": ("high: 5 m/s", "hihg: 5", "inputs.speed.hihg = 5: unknown key; did you mean 'high'"),
    "index": ("pawn", "sobol", "indices.1 = 'sobol': unknown index"),
    "output": ("dent: um", "dent: {unit: um}", "outputs.dent.unit = 'um': unknown key"),
    "limit": ("seed", "limits: {force: 3 mm}\nseed", "limits.force = '3 mm'.*wrong dimension"),
    "limited": ("seed", "limits: {forc: 3}\nseed", "limits.forc = 3: unknown key; did you mean"),
    "none": ("  dent: um\n", "", None),
    "inputs": ("indices", "inputs: {}\nindices", "duplicate"),
}


@pytest.mark.parametrize("case", TEXTS)
def test_a_wrong_key_is_named(tmp_path, columns, validator, case):
    old, new, words = TEXTS[case]
    path = _written(tmp_path, columns, TEXT.replace(old, new))
    if words is None:
        assert read_any(path).outputs.keys() == {"force"}
        assert validator.is_valid(read_mapping(path.read_text(), str(path)))
        return
    with pytest.raises(StudyError, match=words):
        read_any(path)
    if case in ("distribution", "index", "output"):
        assert not validator.is_valid(read_mapping(path.read_text(), str(path)))


def test_other_commands_name_the_right_one(tmp_path, columns):
    path = _written(tmp_path, columns)
    with pytest.raises(StudyError, match="has the rows of a table for runs: use `impactlab go"):
        read_study(path)
