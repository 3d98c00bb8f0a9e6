"""The built site as a reader has it: links, what pages ask for, and code blocks that run."""

import ast
import json
import re
import shlex
import shutil
import warnings
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from types import ModuleType
from typing import Any
from urllib.parse import unquote, urlsplit

import pytest
from command_line import called

import impactlab as il

pytestmark = pytest.mark.site
ROOT = Path(__file__).parents[2]
SITE = ROOT / "site"
PAGES = sorted(SITE.rglob("*.html")) if SITE.exists() else []
CHROMIUM = shutil.which("chromium")
TEXTS = ("README.md", "docs/index.md", "docs/start.md")


class Read(HTMLParser):
    """Ids, links that a reader may follow, and addresses that a browser loads."""

    def __init__(self, path):
        super().__init__()
        self.ids: set[str] = set()
        self.links: list[str] = []
        self.loaded: list[str] = []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attrs):
        given = {name: value or "" for name, value in attrs}
        self.ids |= {given[name] for name in ("id", "name") if name in given}
        followed = tag in ("a", "area") or (tag == "link" and given.get("rel") in ("next", "prev"))
        for name in ("href", "src", "srcset", "data", "poster"):
            if name in given and not given[name].startswith("data:"):
                (self.links if followed else self.loaded).append(given[name])


read = cache(Read)


def test_there_is_a_site():
    assert {page.name for page in PAGES} >= {"index.html", "api.html", "verification.html"}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(SITE)))
def test_links_lead_somewhere_and_nothing_else_is_loaded(page):
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


MISDRAWN = """() => {
  const box = (node) => node.getBoundingClientRect(), last = (node) => node.lastElementChild;
  const wrong = {
    msqrt: (node) => box(node).height < box(node.firstElementChild).height,
    msub: (node) => box(last(node)).left < box(node.firstElementChild).right - 2,
    munderover: (node) => last(node).getAttribute("stretchy") === "false",
  };
  const nodes = Object.keys(wrong).map((name) => [...document.querySelectorAll(name)]);
  return document.fonts.ready.then(() => ({
    fonts: [...document.fonts].filter((f) => f.status === "loaded").map((f) => f.family),
    counts: nodes.map((list) => list.length),
    misdrawn: nodes.flat().filter((n) => wrong[n.localName](n)).map((n) => n.outerHTML),
  }));
}"""
"""Roots lower than what they span, and subscripts that are not beside their letter."""


@pytest.fixture
def browser():
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    if CHROMIUM is None:
        pytest.skip("there is no command chromium")
    with playwright.sync_playwright() as driver:
        chromium = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield chromium
        chromium.close()


@pytest.mark.chromium
def test_equations_are_drawn_as_written(browser):
    page: Any = browser.new_page()
    page.goto((SITE / "theory.html").as_uri())
    drawn = page.evaluate(MISDRAWN)
    assert any("STIX Two Math" in family for family in drawn["fonts"])
    assert min(drawn["counts"][:2]) > 0
    assert drawn["misdrawn"] == []


def test_fractions_have_braces():
    r"""The renderer takes \frac12 m for 12 over m."""
    texts = {path: path.read_text(encoding="utf-8") for path in (ROOT / "docs").rglob("*.md")}
    loose = re.compile(r"\\[dt]?frac(?! *\{)")
    assert {
        path.name: loose.findall(text) for path, text in texts.items() if loose.search(text)
    } == {}


@pytest.mark.chromium
def test_no_page_asks_for_anything_outside(browser):
    asked: set[str] = set()
    complaints: list[str] = []
    page: Any = browser.new_page(viewport={"width": 420, "height": 800})
    page.on("request", lambda request: asked.add(request.url))
    page.on("console", lambda said: complaints.append(f"{page.url}: {said.text}"))
    page.on("pageerror", lambda error: complaints.append(f"{page.url}: {error}"))
    wide = []
    for path in PAGES:
        page.goto(path.as_uri())
        if page.evaluate("document.documentElement.scrollWidth > window.innerWidth"):
            wide.append(path.name)
    assert {url for url in asked if not url.startswith(("file://", "data:", "blob:"))} == set()
    assert complaints == []
    assert wide == []


@pytest.mark.parametrize(
    ("page", "figures"), [("one_impact", 2), ("sensitivity", 3), ("velocity", 1)]
)
def test_notebooks_show_their_figures(page, figures):
    text = (SITE / "tutorials" / f"{page}.html").read_text(encoding="utf-8")
    assert len(re.findall(r"<img [^>]*_images/", text)) == figures


def test_every_tutorial_is_a_notebook_to_download():
    for path in (ROOT / "docs" / "tutorials").glob("*.md"):
        links = read(SITE / "tutorials" / f"{path.stem}.html").links
        books = [link for link in links if link.endswith(".ipynb")]
        assert len(books) == (path.stem != "index"), path.stem
        for book in books:
            cells = json.loads((SITE / "tutorials" / book).read_text(encoding="utf-8"))["cells"]
            assert {cell["cell_type"] for cell in cells} == {"markdown", "code"}


def test_every_study_has_a_page_with_answer_and_figures():
    """Answers and figures of large studies are those that `make stored` keeps."""
    bare = set()
    for path in (ROOT / "studies").glob("*.yaml"):
        if path.stem != "verification":
            text = (SITE / "gallery" / f"{path.stem}.html").read_text(encoding="utf-8")
            if "<figure" not in text or "The answer" not in text:
                bare.add(path.stem)
    assert not bare


@pytest.mark.parametrize("name", ["witness", "witness_parts", "witness_swing"])
def test_pages_beside_3d_elements_open_on_the_comparison(name):
    text = (SITE / "gallery" / f"{name}.html").read_text(encoding="utf-8")
    figures = re.findall(r'<img [^>]*src="\.\./_images/(\w+)\.png"', text)
    assert figures[0].startswith("witness")
    opened = text.partition("<details")[0]
    assert "3-D" in opened
    assert "Convergence" not in opened.partition("The answer")[2]


def test_every_public_name_is_on_the_page_of_the_api():
    names = {name for name in dir(il) if not isinstance(getattr(il, name), ModuleType)}
    names |= {f"plot.{name}" for name in il.plot.__all__}
    assert {f"impactlab.{name}" for name in names} <= read(SITE / "api.html").ids


@pytest.mark.parametrize("text", [*TEXTS, "CONTRIBUTING.md", "results/README.md"])
def test_links_of_texts_lead_somewhere(text):
    path = ROOT / text
    links = re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", path.read_text(encoding="utf-8"))
    inside = [link for link in links if not urlsplit(link).scheme]
    assert [link for link in inside if not (path.parent / link).exists()] == []


PYTHON = re.compile(r"^```python\n(.*?)^```", re.DOTALL | re.MULTILINE)
COMMAND = re.compile(r"^    (impactlab [^#\n]*)", re.MULTILINE)
CODE = [
    path
    for path in (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))
    if path.stem != "kratos"  # takes many minutes; `make kratos` runs its own tests
    if PYTHON.search(text := path.read_text(encoding="utf-8")) or COMMAND.search(text)
]
LEFT_OUT = re.compile(r"verify|calibrate|witness(?!.* --(dry-run|deck))|\.\.\.")
"""Commands of minutes, and those with an ellipsis."""


def test_short_recipes_are_short():
    page = (ROOT / "docs" / "howto.md").read_text(encoding="utf-8")
    recipes = page.split("\n## Short recipes\n")[1].split("\n## ")[0]
    blocks = {block: ast.parse(block).body for block in PYTHON.findall(recipes)}
    assert blocks
    imports = ast.Import | ast.ImportFrom
    counts = {
        block: sum(not isinstance(node, imports) for node in nodes)
        for block, nodes in blocks.items()
    }
    assert {block: count for block, count in counts.items() if count > 5} == {}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A working folder with the studies, and what the site solved of two of them."""
    from matplotlib import pyplot

    pyplot.switch_backend("agg")
    monkeypatch.chdir(tmp_path)
    shutil.copytree(ROOT / "studies", tmp_path / "studies")
    for name in ("velocity", "sobol"):
        (tmp_path / "results" / name).mkdir(parents=True)
        for file in (ROOT / "results" / name).glob("*.nc"):
            shutil.copy(file, tmp_path / "results" / name)
    return tmp_path


@pytest.mark.parametrize("path", CODE, ids=lambda path: path.stem)
def test_code_blocks_run(path, folder):
    """Python in one session; then the study as a file, and the commands on it."""
    from matplotlib import pyplot

    whole = path.read_text(encoding="utf-8")
    session: dict[str, Any] = {}
    for block in PYTHON.findall(whole):
        exec(block, session)
        pyplot.close("all")
    for block in re.findall(r"^```yaml\n(# \S+\.yaml\n.*?)^```", whole, re.DOTALL | re.MULTILINE):
        (folder / block.split()[1]).write_text(block)
    quick = re.compile(
        r"`(impactlab (?:simulate|go|recommend) [^`\n]*(?:--velocity|depth.yaml)[^`\n]*)`"
    )
    commands = COMMAND.findall(whole) + quick.findall(whole)
    for words in (command for command in commands if not LEFT_OUT.search(command)):
        with warnings.catch_warnings(action="default"):  # as on the command line
            done = called(*shlex.split(words)[1:], cwd=folder)
        assert done.returncode == 0, f"{words}: {done.stderr}"


def test_a_notebook_shows_the_progress_on_one_line(tmp_path):
    """In a real kernel: the front end draws over what is before a carriage return."""
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    code = f"""
import impactlab as il
il.Study(
    title="Few", impact=il.paper_impact(), duration="1 ms", responses=["peak_force"],
    discretisation=il.Discretisation(nodes=21), results={str(tmp_path)!r},
    sampling=il.Grid(parameters={{"velocity": [1, 2, 3]}}),
).run(workers=2);
"""
    book = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(code)])
    nbclient.NotebookClient(book, timeout=240, kernel_name="python3").execute()
    outputs = book.cells[0].outputs
    assert {output.output_type for output in outputs} == {"stream"}
    drawn = "".join(output.text for output in outputs if output.name == "stdout")
    assert drawn.count("\n") == 1, "the bar takes several lines"
    last = re.sub(r"\x1b\[[0-9;?]*\w", "", drawn.rstrip().rpartition("\r")[2])
    assert re.search(r"^runs\b.* 3/3 .* 0 failed", last), last
