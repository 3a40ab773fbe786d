"""The console for those who use it by keyboard, screen reader or with weak sight: checked by axe-core."""

from __future__ import annotations

import pytest
from console_server import ROOT
from playwright.sync_api import Page, expect

pytestmark = pytest.mark.browser

AXE = ROOT / "web" / "node_modules" / "axe-core" / "axe.min.js"
SERIOUS = """async () => (await axe.run(document, { resultTypes: ['violations'] })).violations
  .filter(v => v.impact === 'serious' || v.impact === 'critical')
  .map(v => v.id + ': ' + v.nodes.map(n => n.target.join(' ') + ' ' + (n.any[0]?.message ?? '')).join(' | '))"""


@pytest.fixture
def scanned(page: Page) -> Page:
    if not AXE.is_file():
        pytest.skip("axe-core is not installed: make setup")
    page.evaluate(AXE.read_text(encoding="utf-8"))
    return page


@pytest.mark.parametrize("theme", ["dark", "light"])
def test_nothing_serious_is_found(scanned: Page, theme: str) -> None:
    if scanned.locator("html").get_attribute("data-theme") != theme:
        scanned.keyboard.press("t")
    expect(scanned.locator("html")).to_have_attribute("data-theme", theme)
    assert scanned.evaluate(SERIOUS) == []


@pytest.mark.parametrize("theme", ["dark", "light"])
def test_nothing_serious_is_found_in_the_sheets(scanned: Page, theme: str) -> None:
    if scanned.locator("html").get_attribute("data-theme") != theme:
        scanned.keyboard.press("t")
    found = {}
    for key, ready in (("?", ".keys"), ("b", ".recording"), (",", ".setting-section"), ("k", ".gauges")):
        scanned.keyboard.press(key)
        scanned.locator(ready).first.wait_for()
        expect(scanned.locator(".sheet[open]")).to_have_count(1)
        if key == ",":
            scanned.locator(".setting-section summary").first.click()
        found[key] = scanned.evaluate(SERIOUS)
        scanned.keyboard.press("Escape")
    scanned.get_by_role("button", name="Who you are").click()
    found["access"] = scanned.evaluate(SERIOUS)
    assert found == {name: [] for name in found}
