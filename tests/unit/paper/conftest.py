"""Fixtures for tests on solved studies."""

from analysis_fixtures import grid_runs as grid_runs
from analysis_fixtures import sample_runs as sample_runs
from analysis_fixtures import stored as stored
from analysis_fixtures import verdicts_of as verdicts_of
