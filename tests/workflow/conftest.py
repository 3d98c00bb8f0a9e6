"""A folder as a user has it."""

import pytest
from command_line import CHECKS, SMALL


@pytest.fixture
def folder(tmp_path):
    """A folder with a small study and one of checks."""
    (tmp_path / "studies").mkdir()
    (tmp_path / "studies" / "small.yaml").write_text(SMALL)
    (tmp_path / "studies" / "checks.yaml").write_text(CHECKS)
    return tmp_path
