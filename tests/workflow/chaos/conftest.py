"""Fixtures of the tests of disturbed studies."""

import pytest
from chaos import new_study, resumed


@pytest.fixture
def folder(tmp_path):
    """A folder with the study."""
    return new_study(tmp_path)


@pytest.fixture(scope="session")
def undisturbed(tmp_path_factory):
    """The runs of the study, solved in one go by one thread."""
    runs, _ = resumed(new_study(tmp_path_factory.mktemp("undisturbed")), "--workers", "1")
    return runs
