"""Pages read back as a browser does."""

import shutil
from contextlib import contextmanager
from html.parser import HTMLParser

import pytest

from impactlab.figures.draw import draw_all
from impactlab.files import read_netcdf, write_netcdf
from impactlab.report.study import write_report

CHROMIUM = shutil.which("chromium")
FLAGS = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
VOID = {"meta", "img", "br", "link", "input", "hr"}


class Page(HTMLParser):
    """Elements with their attributes, the text, and whether tags are closed in order."""

    def __init__(self, source):
        super().__init__()
        self.source = source
        self.elements: list[tuple[str, dict[str, str]]] = []
        self.text = ""
        self.open: list[str] = []
        self.tables: dict[str, list[list[str]]] = {}
        self._rows: list[list[str]] = []
        self.feed(source)
        self.close()
        self.text = " ".join(self.text.split())

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, {key: value or "" for key, value in attrs}))
        if tag not in VOID:
            self.open.append(tag)
        if tag == "caption":
            self._rows = []
            self._caption = ""
        if tag == "tr":
            self._rows.append([])
        if tag in ("td", "th"):
            self._rows[-1].append("")

    def handle_endtag(self, tag):
        assert self.open, f"</{tag}> closes nothing"
        assert self.open.pop() == tag
        if tag == "caption":
            self.tables[self._caption] = self._rows

    def handle_data(self, data):
        if "style" in self.open:
            return
        self.text += f" {data}"
        if "caption" in self.open:
            self._caption += data
        elif any(tag in self.open for tag in ("td", "th")):
            self._rows[-1][-1] += data

    def named(self, tag):
        """Attributes of every element of a kind."""
        return [attrs for name, attrs in self.elements if name == tag]


@pytest.fixture
def report(tmp_path):
    """A function that writes a study's report, without figures, and reads it back."""

    def write(runs, analysis):
        figures = tmp_path / "figures"
        figures.mkdir(exist_ok=True)
        (figures / "captions.json").write_text("{}")
        write_report(runs, analysis, figures, tmp_path / "report.html")
        return Page((tmp_path / "report.html").read_text("utf-8"))

    return write


@pytest.fixture
def page():
    """The class that reads a page."""
    return Page


@pytest.fixture(scope="module")  # its event loop runs until then
def browser():
    """Chromium, as Debian has it."""
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    if CHROMIUM is None:
        pytest.skip("there is no command chromium")
    with playwright.sync_playwright() as driver:
        chromium = driver.chromium.launch(executable_path=CHROMIUM, args=list(FLAGS))
        yield chromium
        chromium.close()


@pytest.fixture
def visit(browser):
    """Open a page as a context, with the addresses it asks for; it must complain of nothing."""

    @contextmanager
    def visiting(address, width):
        page = browser.new_page(viewport={"width": width, "height": 900})
        asked: list[str] = []
        complaints: list[str] = []
        page.on("request", lambda request: asked.append(request.url))
        page.on("console", lambda message: complaints.append(message.text))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.goto(address)
        yield page, asked
        page.close()
        assert complaints == []

    return visiting


@pytest.fixture(scope="session")
def drawn(tmp_path_factory):
    """A folder for what `results` copies: figures take a second to draw."""
    return tmp_path_factory.mktemp("drawn")


@pytest.fixture
def results(velocity_study, drawn, tmp_path):
    """A results folder with one study, figures and all."""
    folder = drawn / "velocity"
    if not folder.exists():
        runs, analysis = velocity_study
        kept = ["contact_duration", "contact_force", "status"]
        runs = runs[kept].isel(velocity=[0, 3, 7], time=slice(None, None, 8))
        draw_all(runs, analysis, folder / "figures")
        write_report(runs, analysis, folder / "figures", folder / "report.html")
        write_netcdf(runs, folder / "runs.nc", "runs")
        stored = read_netcdf(folder / "runs.nc", "runs")
        write_netcdf(analysis, folder / "analysis.nc", "analysis", stored)
    shutil.copytree(drawn, tmp_path / "results")
    return tmp_path / "results"
