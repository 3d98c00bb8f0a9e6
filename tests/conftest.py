"""Fewer rounds of garbage collection, which take a tenth of the tests' time; blank pictures."""

import gc
from pathlib import Path

import pytest

gc.set_threshold(100_000)


def pytest_collection_finish():
    """Leave out of later rounds what collecting the tests has loaded."""
    gc.collect()
    gc.freeze()


class BlankCanvas:
    """A canvas that writes pictures with nothing in them."""

    def __init__(self, figure):
        pass

    def print_svg(self, path, metadata):
        Path(path).write_text('<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9"/>')

    def print_png(self, path, metadata):
        Path(path).write_bytes(b"\x89PNG\r\n\x1a\n")


@pytest.fixture
def blank_pictures(monkeypatch):
    """Leave pictures blank, which take seconds to draw; captions, data and pages are written."""
    canvases = {"svg": BlankCanvas, "png": BlankCanvas}
    monkeypatch.setattr("impactlab.figures.draw._CANVASES", canvases)
