"""The page in a real browser: typed, read, judged, by keyboard; nothing fetched from elsewhere, no script let in."""

from __future__ import annotations

import pytest

pytest.importorskip("starlette", reason="the extra 'serve' is not installed")
pytest.importorskip("selenium", reason="Selenium is not installed")
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import Select, WebDriverWait

from canon.serve import Limits, application

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def address(running):
    with running(application(Limits(workers=1, rate=1e6, burst=1e6))) as client:
        yield f"http://127.0.0.1:{client.port}/"


@pytest.fixture
def page(browser, address):
    browser.get_log("browser")
    browser.get(address)
    wait(browser, lambda: browser.find_elements(By.CSS_SELECTOR, "#answer textarea"))
    yield browser
    assert [line for line in browser.get_log("browser") if line["level"] == "SEVERE"] == []


def wait(browser, seen):
    return WebDriverWait(browser, 60).until(lambda _: seen())


def field(page, key):
    return page.find_element(By.ID, f"field-{key}")


def typed(page, key, text):
    field(page, key).clear()
    field(page, key).send_keys(text)


def letters(page, key):
    found = page.find_elements(By.CSS_SELECTOR, f"#field-{key}-reading math mi")
    return [page.execute_script("return arguments[0].textContent", each) for each in found]


def filled(page):
    page.find_element(By.ID, "example").click()
    wait(page, lambda: letters(page, "claim"))


def shown_text(page):
    return page.find_element(By.ID, "verdict").text


def test_what_is_typed_is_shown_as_it_was_read(page):
    filled(page)
    for text in (r"\ddot\theta + \frac{g}{l}\sin\theta = 0", "theta'' + g/l*sin(theta) = 0"):
        typed(page, "claim", text)
        wait(page, lambda: letters(page, "claim") == ["θ", "g", "l", "sin", "θ"])
    math = page.find_element(By.CSS_SELECTOR, "#field-claim-reading math")
    assert (
        page.execute_script("return arguments[0].namespaceURI", math) == "http://www.w3.org/1998/Math/MathML"
    )
    typed(page, "parameters", "m, l positive")
    wait(page, lambda: "g is not declared" in page.find_element(By.ID, "field-claim-error").text)
    assert field(page, "claim").get_attribute("aria-invalid") == "true"
    typed(page, "parameters", "m, l, g positive")
    wait(page, lambda: letters(page, "claim"))
    assert field(page, "claim").get_attribute("aria-invalid") == "false"


def test_right_wrong_and_unreadable_are_told_apart(page):
    filled(page)
    for text, word in (
        ("theta'' + g/l*sin(theta) = 0", "It holds"),
        ("theta'' + g/(2*l)*sin(theta) = 0", "should be twice that"),
        ("theta'' + g/l*sin(theta", "can't be read"),
    ):
        typed(page, "claim", text)
        page.find_element(By.ID, "check").click()
        wait(page, lambda word=word: word in shown_text(page))
    region = page.find_element(By.ID, "verdict")
    assert (region.get_attribute("role"), region.get_attribute("aria-live")) == ("status", "polite")


NO_MATHML = """
const asked = window.fetch;
window.fetch = (path, said) => path === "read" && !JSON.parse(said.body).key
  ? Promise.resolve(new Response('{"read": true, "warnings": [], "statements": [{"mathml": "", "plain": ""}]}'))
  : asked(path, said);
"""


@pytest.mark.parametrize("long", [False, True])
def test_a_corrected_answer_is_shown_whatever_its_length(page, long):
    """As a formula, and as text where it is too long for the service to set."""
    filled(page)
    if long:
        page.execute_script(NO_MATHML)
    typed(page, "claim", "theta'' + g/(2*l)*sin(theta) = 0")
    page.find_element(By.ID, "check").click()
    wait(page, lambda: page.find_elements(By.CSS_SELECTOR, ".corrected code" if long else ".corrected math"))
    shown = page.find_element(By.CSS_SELECTOR, ".corrected").text
    assert "parsing" not in shown
    assert not long or "sin(theta)" in shown


def test_the_keyboard_is_enough(page):
    page.find_element(By.TAG_NAME, "body").send_keys(Keys.TAB)
    order = []
    for _ in range(9):
        order.append(page.switch_to.active_element.get_attribute("id") or page.switch_to.active_element.text)
        outline = page.execute_script("return getComputedStyle(document.activeElement).outlineStyle")
        assert outline != "none", order
        page.switch_to.active_element.send_keys(Keys.TAB)
    wanted = [
        "Skip to the verdict",
        "kind",
        "example",
        "field-q",
        "field-parameters",
        "field-functions",
        "field-L",
    ]
    assert order[:8] == [*wanted, "field-claim"]
    page.find_element(By.ID, "example").send_keys(Keys.ENTER)
    field(page, "claim").send_keys(Keys.CONTROL, Keys.ENTER)
    wait(page, lambda: "It holds" in shown_text(page))


def test_every_kind_has_labels_and_descriptions_that_exist(page):
    kinds = Select(page.find_element(By.ID, "kind"))
    for name in [option.text for option in kinds.options]:
        kinds.select_by_visible_text(name)
        missing = page.execute_script(
            """return [...document.querySelectorAll('form input, form textarea, form select')].filter((one) =>
                 !one.labels.length || !one.labels[0].textContent.trim()
                 || (one.getAttribute('aria-describedby') ?? '').split(' ').filter(Boolean)
                      .some((id) => !document.getElementById(id))).map((one) => one.id)"""
        )
        assert missing == [], name
        assert page.find_elements(By.CSS_SELECTOR, "#answer .row"), name


def test_nothing_comes_from_elsewhere_and_no_script_is_let_in(page, address):
    fetched = page.execute_script("return performance.getEntriesByType('resource').map((one) => one.name)")
    assert {"page.js", "page.css", "kinds.json"} <= {name.removeprefix(address) for name in fetched}
    assert all(name.startswith(address) for name in fetched)
    filled(page)
    typed(page, "claim", "<img src=x onerror='document.title=1'><script>document.title=2</script>")
    page.find_element(By.ID, "check").click()
    wait(page, lambda: "can't be read" in shown_text(page))
    assert not page.find_elements(By.TAG_NAME, "img")
    assert page.title.startswith("canon")
    page.execute_script(
        """const made = document.createElement('script'); made.textContent = 'document.title = "taken"';
           document.body.append(made);"""
    )
    assert page.title.startswith("canon")
    refused = [line for line in page.get_log("browser") if "Content Security Policy" in line["message"]]
    assert len(refused) == 1


@pytest.mark.parametrize("width", [320, 390, 1200])
def test_nothing_is_wider_than_the_window(page, width):
    page.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride",
        {"width": width, "height": 800, "deviceScaleFactor": 1, "mobile": width < 600},
    )
    try:
        filled(page)
        page.find_element(By.ID, "check").click()
        wait(page, lambda: "It holds" in shown_text(page))
        assert page.execute_script("return document.documentElement.scrollWidth") <= width
    finally:
        page.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


LUMINANCE = """
const part = (c) => { c /= 255; return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4; };
const light = (rgb) => 0.2126 * part(rgb[0]) + 0.7152 * part(rgb[1]) + 0.0722 * part(rgb[2]);
const numbers = (text) => text.match(/[\\d.]+/g).map(Number);
const behind = (one) => { for (let at = one; at; at = at.parentElement) {
  const found = numbers(getComputedStyle(at).backgroundColor);
  if (found.length === 3 || found[3] > 0) return found; } return [255, 255, 255]; };
const worst = {};
for (const one of document.querySelectorAll('body *')) {
  if (![...one.childNodes].some((node) => node.nodeType === 3 && node.data.trim()) && !one.value) continue;
  if (!one.getClientRects().length || one.closest('.skip')) continue;
  const [a, b] = [light(numbers(getComputedStyle(one).color)), light(behind(one))];
  const contrast = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
  const key = one.tagName + '.' + one.className;
  worst[key] = Math.min(worst[key] ?? 99, contrast);
}
return worst;
"""


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_everything_can_be_told_from_what_is_behind_it(page, scheme):
    page.execute_cdp_cmd(
        "Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": scheme}]}
    )
    filled(page)
    for text, word in (
        ("theta'' = sin(theta)", "fails"),
        ("theta''(", "can't be read"),
        ("theta'' + g/l*sin(theta)", "holds"),
    ):
        typed(page, "claim", text)
        page.find_element(By.ID, "check").click()
        wait(page, lambda word=word: word in shown_text(page))
        contrast = page.execute_script(LUMINANCE)
        assert len(contrast) > 8
        assert min(contrast.values()) >= 4.5, {key: value for key, value in contrast.items() if value < 4.5}
