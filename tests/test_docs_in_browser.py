"""The documentation in a real browser: no page is wider than a phone, all can be read, nothing comes from elsewhere.

One page of each kind is built, with what its code prints: of all pages that takes ten minutes.
"""

import functools
import http.server
import os
import subprocess
import sys
import threading
from pathlib import Path

import pytest

pytest.importorskip("selenium", reason="Selenium is not installed")
from selenium.webdriver.support.ui import WebDriverWait

HOME = Path(__file__).parents[1]
pytestmark = pytest.mark.slow

KEPT = (
    "index.md", "tutorials/1_pendulum.md", "howto/studies.md", "howto/plot_and_save.md", "explanation/formal_series.md",
    "conventions.md", "architecture.md", "measured.md", "compare.md", "sheets.md", "scenes.md", "seeds.md", "books.md",
    "reference/glossary.md",
)  # fmt: skip
EXAMPLE = "judge/one_answer.py"
NAME = "canon.flow.propagation.propagate"
REFERENCE = f"# A name\n\n```{{eval-rst}}\n.. autosummary::\n   :toctree: generated\n\n   ~{NAME}\n```\n"
PAGES = (
    *(page.removesuffix(".md") for page in KEPT), f"reference/generated/{NAME}", "reference/command_line",
    "gallery/index", "gallery/judge/one_answer", "genindex",
)  # fmt: skip


def keep_one_page_of_each_kind(clone):
    docs, examples = clone / "docs", clone / "examples"
    for page in docs.rglob("*.md"):
        if page.relative_to(docs).as_posix() not in KEPT:
            page.unlink()
    for script in examples.glob("*/*.py"):
        if script.relative_to(examples).as_posix() != EXAMPLE:
            script.unlink()
    (docs / "reference" / "a_name.md").write_text(REFERENCE, encoding="utf-8")


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    pytest.importorskip("myst_nb", reason="the extra 'docs' is not installed")
    clone = tmp_path_factory.mktemp("pages") / "canon"
    subprocess.run(["git", "clone", "--quiet", "--no-hardlinks", str(HOME), str(clone)], check=True)
    keep_one_page_of_each_kind(clone)
    excluded = "exclude_patterns=_build,jupyter_execute,_templates,paper,gallery/**.ipynb,reference/api.md"
    done = subprocess.run(
        [sys.executable, "-m", "sphinx", "-q", "-b", "html", "-D", excluded, "docs", "docs/_build"],
        cwd=clone, env={**os.environ, "PYTHONPATH": str(clone)}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return clone / "docs" / "_build"


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


@pytest.fixture(scope="module")
def address(built):
    with http.server.ThreadingHTTPServer(
        ("127.0.0.1", 0), functools.partial(Quiet, directory=built)
    ) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_address[1]}/"
        server.shutdown()


@pytest.fixture
def shown(browser, address):
    """Show a page in a window of some width, in light or dark, everything that is folded open."""

    def show(page, width=390, scheme="light"):
        window = {"width": width, "height": 800, "deviceScaleFactor": 1, "mobile": width < 600}
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", window)
        colours = [{"name": "prefers-color-scheme", "value": scheme}]
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": colours})
        browser.get(f"{address}{page}.html")
        ready = "return document.readyState === 'complete'"
        WebDriverWait(browser, 60).until(lambda _: browser.execute_script(ready))
        browser.execute_script("document.querySelectorAll('details').forEach((one) => one.open = true)")
        return browser

    browser.get_log("browser")
    yield show
    browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    assert [line for line in browser.get_log("browser") if line["level"] == "SEVERE"] == []


WIDER = """
return ['html', '.content'].map((name) => document.querySelector(name)).filter((one) => one)
  .map((one) => one.scrollWidth - Math.min(one.clientWidth, arguments[0]));
"""
"""By how much the page, and its text, which scrolls by itself on a phone, are wider than the window."""


@pytest.mark.parametrize("page", PAGES)
def test_nothing_is_wider_than_the_window(shown, page):
    for width in (320, 390, 1024, 1200, 1366, 1920):
        assert max(shown(page, width).execute_script(WIDER, width)) <= 0, f"of {width}"


@pytest.mark.parametrize("width", [390, 1200])
def test_what_is_wider_than_the_window_is_noticed(shown, width):
    page = shown("index", width)
    page.execute_script(f"document.querySelector('h1').style.width = '{width}px'")
    assert max(page.execute_script(WIDER, width)) > 0


CONTRAST = """
const part = (c) => { c /= 255; return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4; };
const light = (rgb) => 0.2126 * part(rgb[0]) + 0.7152 * part(rgb[1]) + 0.0722 * part(rgb[2]);
const dot = new OffscreenCanvas(1, 1).getContext('2d', {willReadFrequently: true});
const read = (text) => { dot.clearRect(0, 0, 1, 1); dot.fillStyle = text; dot.fillRect(0, 0, 1, 1);
  return [...dot.getImageData(0, 0, 1, 1).data]; };
const known = {}, colour = (text) => known[text] ??= read(text);
const over = (top, below) => [0, 1, 2].map((k) => (top[3] * top[k] + (255 - top[3]) * below[k]) / 255);
const behind = (one) => { const found = [];
  for (let at = one; at; at = at.parentElement) found.unshift(colour(getComputedStyle(at).backgroundColor));
  return found.reduce((below, top) => over(top, below), [255, 255, 255]); };
const worst = {};
for (const one of document.querySelectorAll('body *')) {
  if (![...one.childNodes].some((node) => node.nodeType === 3 && node.data.trim())) continue;
  if (!one.getClientRects().length) continue;
  if (!one.checkVisibility({visibilityProperty: true, opacityProperty: true})) continue;
  const style = getComputedStyle(one), paper = behind(one);
  const [a, b] = [light(over(colour(style.color), paper)), light(paper)];
  const size = parseFloat(style.fontSize);  // 18 points, or 14 in bold, are large
  const wanted = size >= 24 || (size >= 18.66 && style.fontWeight >= 700) ? 3 : 4.5;
  const reached = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05) / wanted;
  const key = [one, one.closest('pre, code, a'), one.closest('td, th'), one.closest('.verdict')]
    .map((each) => each?.localName ?? '').join(' ') + ' ' + one.className;
  worst[key] = Math.min(worst[key] ?? 99, reached);
}
return worst;
"""
"""Contrast of each kind of text over what WCAG 2.2 asks for at level AA."""

MET = {
    "index": {"a", "code", "pre", "td", "h1"},
    "tutorials/1_pendulum": {"a", "b", "code", "pre"},
    "measured": {"code", "pre", "td", "th", "summary"},
}
"""Some of the elements whose text is looked at."""


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("page", PAGES)
def test_everything_can_be_told_from_what_is_behind_it(shown, page, scheme):
    found = shown(page, 1200, scheme).execute_script(CONTRAST)
    assert len(found) > 8
    assert {name for key in found for name in key.split()} >= MET.get(page, set())
    assert {key: value for key, value in found.items() if value < 1} == {}


def test_the_words_of_verdicts_are_looked_at(shown):
    """On the first page beside an answer, in the tutorial before what was asked; pale ones would be found."""
    first = shown("index", 1200, "dark").execute_script(CONTRAST)
    assert any("verdict" in key for key in first)
    tutorial = shown("tutorials/1_pendulum", 1200, "dark")
    words = tutorial.execute_script(
        "return [...document.querySelectorAll('pre > b')].map((b) => b.textContent)"
    )
    assert {"HOLDS", "FAILS"} <= set(words)
    tutorial.execute_script(
        "document.querySelector('pre > b').style.setProperty('color', '#555', 'important')"
    )
    assert min(tutorial.execute_script(CONTRAST).values()) < 1


@pytest.mark.parametrize("page", PAGES)
def test_nothing_comes_from_elsewhere(shown, address, page):
    entries = "return performance.getEntriesByType('resource').map((one) => one.name)"
    fetched = shown(page).execute_script(entries)
    assert any(name.endswith(".css") for name in fetched)
    assert [name for name in fetched if not name.startswith((address, "data:"))] == []


def test_the_first_page_leads_to_the_pages_that_are_made_when_built(shown, built):
    links = "return [...document.querySelectorAll('table a')].map((one) => one.getAttribute('href'))"
    found = shown("index").execute_script(links)
    for page in ("gallery/index.html", "reference/command_line.html"):
        assert page in found
        assert (built / page).exists()
