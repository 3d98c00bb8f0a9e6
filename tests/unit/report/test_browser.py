"""The report of a sample, read and clicked through in a browser."""

import re

import pytest
import samples

from impactlab.figures.draw import draw_all
from impactlab.report.results import write_index
from impactlab.report.study import write_report

pytestmark = [pytest.mark.chromium, pytest.mark.slow]
ALIKE = ("pawn", "regression", "surrogate_first_order", "total_order_by_samples")
"""Left out: their figures look like others, and each takes seconds to draw."""
PAGES = 8
"""Most pages of a printed report."""
FOCUS = "document.activeElement"
"""A page of playwright's, with what it asked for (`asked`) and complained of (`complaints`)."""


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    """A report with failures, a mostly constant response and most kinds of indices."""
    folder = tmp_path_factory.mktemp("sample")
    runs = samples.sample(128, 5, failures=5)[["peak_force", "remote_plastic_strain", "status"]]
    analysis = samples.indices(runs).drop_vars(ALIKE)
    draw_all(runs, analysis, folder / "figures")
    write_report(runs, analysis, folder / "figures", folder / "report.html")
    return (folder / "report.html").as_uri()


@pytest.fixture
def page(visit, address):
    """The report, opened; at the end it must have asked for nothing."""
    with visit(address, 1280) as (page, asked):
        yield page
    assert [url for url in asked if not url.startswith(("data:", address))] == []


def test_the_keyboard_reaches_everything_in_the_order_of_the_page(page):
    wanted = page.evaluate(
        '[...document.querySelectorAll(\'a[href]:not([tabindex="-1"]), summary, [tabindex="0"]\')]'
        ".filter(e => e.checkVisibility({contentVisibilityAuto: true})).length"
    )
    seen = []
    for _ in range(wanted):
        page.keyboard.press("Tab")
        seen.append(
            page.evaluate(
                f"[{FOCUS}.tagName, {FOCUS}.getAttribute('href'), "
                f"parseFloat(getComputedStyle({FOCUS}).outlineWidth)]"
            )
        )
    assert seen[0][:2] == ["A", "#main"]
    assert all(name in ("A", "SUMMARY", "DIV", "PRE") for name, _, _ in seen)
    assert all(outline >= 2 for _, _, outline in seen), "focus is not visible"
    links = page.locator('a[href]:not([tabindex="-1"]):visible').count()
    assert len({href for _, href, _ in seen if href}) == links > 15


def test_the_navigation_leads_to_each_section(page):
    links = page.locator("nav a")
    titles = links.all_inner_texts()
    assert titles[:2] == ["Ranking", "First and total order"]
    assert titles[-1] == "Provenance"
    for at, title in enumerate(titles):
        links.nth(at).click()
        target = page.locator(page.url.partition("#")[2].join(("#", "")))
        assert title in target.locator("h2").first.inner_text()
        top = target.evaluate("e => e.getBoundingClientRect().top")
        assert -1 < top < 900
    assert page.locator("main section").count() == 1 + len(titles), "the answer has no link"


def test_every_fold_opens_by_keyboard(page):
    folds = page.locator("details")
    assert folds.count() > 10
    for fold in folds.all():
        fold.locator("summary").first.focus()
        assert not fold.evaluate("e => e.open")
        page.keyboard.press("Enter")
        assert fold.evaluate("e => e.open")


@pytest.mark.parametrize(("width", "clipped"), [(1300, 0), (420, None)])
def test_nothing_is_wider_than_the_window(page, width, clipped):
    page.set_viewport_size({"width": width, "height": 900})
    for fold in page.locator("details").all():
        fold.evaluate("e => e.open = true")
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    if clipped is not None:
        wide = (
            "[...document.querySelectorAll('.scroll')].filter(e => e.scrollWidth > e.clientWidth)"
        )
        assert page.evaluate(f"{wide}.map(e => e.getAttribute('aria-label'))") == []


@pytest.mark.parametrize(("width", "shown"), [(1300, ".answer, .answer img"), (420, ".answer ul")])
def test_the_first_screen_shows_the_answer(page, width, shown):
    page.set_viewport_size({"width": width, "height": 900})
    ends = page.locator(shown).evaluate_all("all => all.map(e => e.getBoundingClientRect().bottom)")
    assert ends
    assert max(ends) < 900
    assert page.locator(".answer li").count() <= 5


def test_every_figure_is_drawn_and_told(page):
    figures = page.locator("figure img")
    assert figures.count() == len(page.locator("figcaption").all()) >= 10
    drawn = figures.evaluate_all("all => all.map(e => e.complete && e.naturalWidth > 0)")
    assert all(drawn)
    told = figures.evaluate_all("all => all.map(e => e.alt)")
    assert len(set(told)) == len(told)
    bars = next(text for text in told if text.startswith("Sobol indices."))
    assert "Peak force: first order: largest for impact velocity (0.711)" in bars


def test_figures_follow_a_dark_page_and_stay_as_drawn_in_print(page):
    seen = "getComputedStyle(document.querySelector('.answer img')).filter"
    assert page.evaluate(seen) == "none"
    page.emulate_media(color_scheme="dark")
    assert "invert" in page.evaluate(seen)
    page.emulate_media(color_scheme="dark", media="print")
    assert page.evaluate(seen) == "none"


def test_the_index_crops_no_thumbnail(browser, results):
    write_index(results, results / "index.html")
    page = browser.new_page(viewport={"width": 1300, "height": 900})
    page.goto((results / "index.html").as_uri())
    assert page.evaluate("getComputedStyle(document.querySelector('img')).objectFit") == "contain"
    page.close()


def test_what_is_in_doubt_is_named_beside_the_numbers(page):
    rows = page.locator("#sensitivity > .scroll tbody tr", has_text="Remote plastic strain")
    assert rows.count() == 2
    assert all("mostly constant" in text for text in rows.all_inner_texts())


def test_prints_without_cutting(page, tmp_path):
    page.emulate_media(media="print")
    page.set_viewport_size({"width": 660, "height": 900})  # between the margins of A4, at 96 dpi
    assert page.evaluate("document.documentElement.scrollWidth") <= 660
    assert not page.locator("nav").is_visible()
    heights = page.locator("figure img").evaluate_all("all => all.map(e => e.offsetHeight)")
    assert max(heights) < 21 / 2.54 * 96 + 1
    answer = page.locator(".answer")
    assert answer.evaluate("e => getComputedStyle(e).breakInside") == "avoid"
    assert answer.evaluate("e => e.getBoundingClientRect().bottom") < 26.7 / 2.54 * 96
    rows = "table => [...table.rows].filter(row => row.checkVisibility()).length"
    assert max(table.evaluate(rows) for table in page.locator("table").all()) <= 21
    printed = page.pdf(path=tmp_path / "report.pdf", format="A4", prefer_css_page_size=True)
    assert len(printed) > 100_000
    assert len(re.findall(rb"/Type /Page\b", printed)) <= PAGES


def test_prints_what_the_reader_opened(page):
    page.emulate_media(media="print")
    fold = page.locator("#provenance details")
    pointer = "getComputedStyle(e.querySelector('summary'), '::after').content"
    assert "HTML page" in fold.evaluate(f"e => {pointer}")
    assert not fold.locator("pre").is_visible()
    fold.evaluate("e => e.open = true")
    assert fold.evaluate(f"e => {pointer}") == "none"
    assert fold.locator("pre").is_visible()
