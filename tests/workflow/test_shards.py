"""The command line on finished runs: their status, and their removal."""

import pytest
from command_line import called as impactlab

STUDY = """
title: Small
impact: {base: paper}
discretisation: {nodes: 11, points: 3}
duration: 1 ms
sampling: {method: grid, parameters: {velocity: [1.0, 2.0, 3.0]}}
responses: [peak_force]
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "studies").mkdir()
    (tmp_path / "studies" / "small.yaml").write_text(STUDY)
    (tmp_path / "studies" / "gone.yaml").write_text(STUDY)
    return tmp_path


def test_status_and_clean(folder):
    assert "0 of 3 runs" in impactlab("status", "studies/small.yaml", cwd=folder).stdout
    for name in ("small", "gone"):
        assert impactlab("run", f"studies/{name}.yaml", cwd=folder).returncode == 0
    (folder / "studies" / "small.yaml").write_text(STUDY.replace("3.0]", "3.0, 4.0]"))
    told = impactlab("status", "studies/small.yaml", cwd=folder).stdout
    assert "3 of 4 runs solved, 1 left" in told
    assert "nobody" in told
    assert "Nothing to remove" in impactlab("clean", cwd=folder).stdout
    (folder / "studies" / "gone.yaml").unlink()
    assert "Nothing to remove" in impactlab("clean", "--yes", cwd=folder).stdout
    (kept,) = folder.glob("results/gone/shards/*/*.npz")
    (shard,) = folder.glob("results/small/shards/*/*.npz")
    (folder / "studies" / "small.yaml").write_text(STUDY.replace("[1.0, 2.0, 3.0]", "[5.0]"))
    refused = impactlab("clean", cwd=folder, said="n\n")
    assert "holds no run of the study" in refused.stdout
    assert shard.exists()
    assert impactlab("clean", "--yes", cwd=folder).returncode == 0
    assert not shard.exists()
    assert kept.exists()


def test_clean_takes_the_folder_of_studies_that_lie_elsewhere(folder):
    (folder / "elsewhere").mkdir()
    mine = folder / "elsewhere" / "mine.yaml"
    mine.write_text(STUDY)
    assert impactlab("run", mine, cwd=folder).returncode == 0
    mine.write_text(STUDY.replace("[1.0, 2.0, 3.0]", "[5.0]"))
    assert "Nothing to remove" in impactlab("clean", "--yes", cwd=folder).stdout
    assert "holds no run" in impactlab("clean", "elsewhere", "--yes", cwd=folder).stdout
    assert not list(folder.glob("results/mine/shards/*/*.npz"))
    # clean does not take a wrong folder for studies
    impactlab("run", "studies/small.yaml", cwd=folder)
    done = impactlab("clean", "results", "--yes", cwd=folder)
    assert done.returncode == 1
    assert "no study files" in done.stderr
    assert list(folder.glob("results/small/shards/*/*.npz"))
