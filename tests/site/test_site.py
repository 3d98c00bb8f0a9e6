"""The built site as a reader has it: links, what pages ask for, and code blocks that run."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from types import ModuleType
from typing import Any
from urllib.parse import unquote, urlsplit

import pytest

import impactlab as il

pytestmark = pytest.mark.site
ROOT = Path(__file__).parents[2]
SITE = ROOT / "site"
PAGES = sorted(SITE.rglob("*.html")) if SITE.exists() else []
CHROMIUM = shutil.which("chromium")
TEXTS = ("README.md", "docs/index.md", "docs/start.md")


class Read(HTMLParser):
    """Ids, links that a reader may follow, and addresses that a browser loads."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.ids: set[str] = set()
        self.links: list[str] = []
        self.loaded: list[str] = []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {name: value or "" for name, value in attrs}
        self.ids |= {given[name] for name in ("id", "name") if name in given}
        followed = tag in ("a", "area") or (tag == "link" and given.get("rel") in ("next", "prev"))
        for name in ("href", "src", "srcset", "data", "poster"):
            if name in given and not given[name].startswith("data:"):
                (self.links if followed else self.loaded).append(given[name])


read = cache(Read)


def test_there_is_a_site() -> None:
    assert {page.name for page in PAGES} >= {"index.html", "api.html", "verification.html"}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(SITE)))
def test_links_lead_somewhere_and_nothing_else_is_loaded(page: Path) -> None:
    broken = []
    for address in [*read(page).links, *read(page).loaded]:
        parts = urlsplit(address)
        if parts.scheme or parts.netloc:
            if address in read(page).loaded or parts.scheme not in ("http", "https", "mailto"):
                broken.append(address)
            continue
        target = (page.parent / unquote(parts.path)).resolve() if parts.path else page
        if not target.is_relative_to(SITE) or not target.is_file():
            broken.append(address)
            continue
        ids = read(target).ids if target.suffix == ".html" else set()
        if parts.fragment and target.suffix == ".html" and unquote(parts.fragment) not in ids:
            broken.append(address)
    assert broken == []


@pytest.mark.chromium
def test_no_page_asks_for_anything_outside() -> None:
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    if CHROMIUM is None:
        pytest.skip("there is no command chromium")
    asked: set[str] = set()
    complaints: list[str] = []
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        page: Any = browser.new_page(viewport={"width": 420, "height": 800})
        page.on("request", lambda request: asked.add(request.url))
        page.on("console", lambda said: complaints.append(f"{page.url}: {said.text}"))
        page.on("pageerror", lambda error: complaints.append(f"{page.url}: {error}"))
        wide = []
        for path in PAGES:
            page.goto(path.as_uri())
            if page.evaluate("document.documentElement.scrollWidth > window.innerWidth"):
                wide.append(path.name)
        browser.close()
    assert {url for url in asked if not url.startswith(("file://", "data:", "blob:"))} == set()
    assert complaints == []
    assert wide == []


@pytest.mark.parametrize(
    ("page", "figures"), [("one_impact", 2), ("sensitivity", 2), ("velocity", 1)]
)
def test_notebooks_show_their_figures(page: str, figures: int) -> None:
    text = (SITE / "tutorials" / f"{page}.html").read_text(encoding="utf-8")
    assert len(re.findall(r"<img [^>]*_images/", text)) == figures


def test_every_public_name_is_on_the_page_of_the_api() -> None:
    names = {name for name in il.__all__ if not isinstance(getattr(il, name), ModuleType)}
    names |= {f"plot.{name}" for name in il.plot.__all__}
    assert {f"impactlab.{name}" for name in names} <= read(SITE / "api.html").ids


@pytest.mark.parametrize("text", [*TEXTS, "CONTRIBUTING.md", "results/README.md"])
def test_links_of_texts_lead_somewhere(text: str) -> None:
    path = ROOT / text
    links = re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", path.read_text(encoding="utf-8"))
    inside = [link for link in links if not urlsplit(link).scheme]
    assert [link for link in inside if not (path.parent / link).exists()] == []


@pytest.mark.parametrize("text", TEXTS)
def test_code_blocks_run(text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Python in one session; then the study as a file, and the quick commands on it."""
    from matplotlib import pyplot

    pyplot.switch_backend("agg")
    monkeypatch.chdir(tmp_path)
    whole = (ROOT / text).read_text(encoding="utf-8")
    session: dict[str, Any] = {}
    for block in re.findall(r"^```python\n(.*?)^```", whole, re.DOTALL | re.MULTILINE):
        exec(block, session)
    pyplot.close("all")
    for block in re.findall(r"^```yaml\n(# \S+\.yaml\n.*?)^```", whole, re.DOTALL | re.MULTILINE):
        file = tmp_path / block.split()[1]
        file.parent.mkdir(exist_ok=True)
        file.write_text(block)
    for one, other in re.findall(
        r"^    (impactlab .*)$|`(impactlab [^`\n]+)`", whole, re.MULTILINE
    ):
        words = one or other
        if re.match(r"impactlab (simulate|go|recommend) .*(--velocity|depth.yaml)", words):
            done = subprocess.run(shlex.split(words), capture_output=True, text=True)
            assert done.returncode == 0, f"{words}: {done.stderr}"
