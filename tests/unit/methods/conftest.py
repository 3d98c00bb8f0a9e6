"""Designs of studies that the tests write."""

import json

import numpy as np
import pytest

from impactlab.study.design import design
from impactlab.study.schema.readers import study_of_text

BOX = {"velocity": (1.0, 2.0), "beam_depth": (0.02, 0.03), "gravity": (0.0, 10.0)}
UNIFORM = {
    name: {"distribution": "uniform", "low": low, "high": high} for name, (low, high) in BOX.items()
}


@pytest.fixture
def designed():
    """The design of a study's text."""
    return lambda text: design(study_of_text("some", text))


@pytest.fixture
def sampled(designed):
    """The design of a sample of three parameters, uniform in BOX, with more or others."""

    def make(method, parameters=None, **others):
        section = {"method": method, "parameters": UNIFORM | (parameters or {})} | others
        study = {"title": "-", "impact": {"base": "paper"}, "duration": 1e-3, "sampling": section}
        if method == "target_hsic":
            study["limits"] = {"peak_force": 1e4}
        return designed(json.dumps(study))

    return make


@pytest.fixture
def cube():
    """The draws of a design on (run, varied parameter), scaled back from BOX to 0..1."""

    def scaled(sample):
        def one(name):
            low, high = BOX[name]
            return (sample[name].values - low) / (high - low)

        return np.stack([one(name) for name in BOX], axis=1)

    return scaled
