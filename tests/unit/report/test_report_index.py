from __future__ import annotations

from pathlib import Path
from typing import Any
from urllib.parse import unquote

import xarray as xr

from impactlab.report.results import write_index


def _index(results: Path, page: Any, path: Path | None = None) -> Any:
    path = path or results / "index.html"
    write_index(results, path)
    return page(path.read_text("utf-8"))


def test_links_every_report(results: Path, page: Any) -> None:
    found = _index(results, page)
    assert found.open == []
    links = [attrs["href"] for attrs in found.named("a") if not attrs["href"].startswith("#")]
    assert links == ["velocity/report.html"]
    assert "The velocity study" in found.text
    assert "6 runs (grid), none failed" in found.text


def test_addresses_are_relative_and_exist(results: Path, page: Any) -> None:
    home = results.parent / "elsewhere" / "index.html"
    found = _index(results, page, home)
    addresses = [attrs["src"] for attrs in found.named("img")]
    addresses += [a["href"] for a in found.named("a") if not a["href"].startswith("#")]
    assert len(addresses) == 2
    assert all((home.parent / unquote(address)).is_file() for address in addresses)
    assert found.named("img")[0]["alt"] == "Contact force during the first contact"


def test_failures_are_told(results: Path, page: Any, failing: Any) -> None:
    path = results / "velocity" / "runs.nc"
    runs = failing(xr.load_dataset(path), {"velocity": 0, "contact": 0})
    path.unlink()
    runs.to_netcdf(path)
    assert "6 runs (grid), 1 failed" in _index(results, page).text


def test_markup_and_odd_names_do_no_harm(results: Path, page: Any) -> None:
    odd = results / 'a "b" #1'
    (results / "velocity").rename(odd)
    runs = xr.load_dataset(odd / "runs.nc")
    (odd / "runs.nc").unlink()
    runs.assign_attrs(title="<i>T</i>").to_netcdf(odd / "runs.nc")
    found = _index(results, page)
    assert found.named("i") == []
    assert "<i>T</i>" in found.text
    link = next(a["href"] for a in found.named("a") if not a["href"].startswith("#"))
    assert (results / unquote(link)).is_file()


def test_folders_without_a_report_are_left_out(results: Path, page: Any) -> None:
    (results / "half").mkdir()
    (results / "half" / "runs.nc").touch()
    (results / "other").mkdir()
    (results / "other" / "report.html").touch()
    assert len(_index(results, page).named("li")) == 1


def test_an_empty_folder_says_what_to_do(tmp_path: Path, page: Any) -> None:
    assert "make study" in _index(tmp_path, page).text
