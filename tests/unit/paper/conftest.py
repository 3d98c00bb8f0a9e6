"""Fixtures for tests of the paper's statements."""

from analysis_fixtures import grid_runs as grid_runs
