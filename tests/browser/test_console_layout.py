"""The console on a phone, a laptop, a large screen: nothing runs over the edge; screenshots to look at."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

pytestmark = pytest.mark.browser

SIZES = [
    (360, 740, "dark"),
    (390, 844, "light"),
    (820, 1180, "light"),
    (1440, 900, "dark"),
    (1440, 900, "light"),
    (3840, 2160, "dark"),
]
BEYOND_THE_EDGE = """() => [...document.querySelectorAll('#console *')]
  .filter(e => { const r = e.getBoundingClientRect(); return r.width && (r.right > innerWidth + 1 || r.left < -1); })
  .map(e => e.className.baseVal ?? e.className)"""


@pytest.mark.parametrize(("width", "height", "theme"), SIZES)
def test_nothing_overflows(page: Page, tmp_path: Path, width: int, height: int, theme: str) -> None:
    page.set_viewport_size({"width": width, "height": height})
    if page.locator("html").get_attribute("data-theme") != theme:
        page.keyboard.press("t")
    expect(page.locator("html")).to_have_attribute("data-theme", theme)
    page.wait_for_timeout(300)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert page.evaluate(BEYOND_THE_EDGE) == []
    box = page.locator(".estop").bounding_box()
    assert box is not None
    assert box["width"] >= 80
    assert box["height"] >= 48
    assert box["y"] + box["height"] <= height
    shot = tmp_path / f"console_{width}x{height}_{theme}.png"
    page.screenshot(path=shot, full_page=True)
    assert shot.stat().st_size > 20_000


REASONS = re.findall(
    r'"(?:reason\.(?:hold|stop|refused)|hint)\.[a-z_]+": "(.*)",',
    (Path(__file__).parents[2] / "web" / "src" / "i18n" / "en.ts").read_text(encoding="utf-8"),
)
CUT_OFF = """(texts) => texts.filter(text => {
  const line = document.querySelector('.reason');
  line.textContent = text;
  line.dataset.long = String(text.length > 37);
  return line.scrollWidth > line.clientWidth;
})"""


@pytest.mark.parametrize("width", [390, 1024, 1280, 1440])
def test_no_reason_is_cut_off(page: Page, width: int) -> None:
    page.set_viewport_size({"width": width, "height": 900})
    assert len(REASONS) > 40
    assert page.evaluate(CUT_OFF, REASONS) == []


def test_stop_stays_in_reach_when_a_phone_is_scrolled(page: Page) -> None:
    page.set_viewport_size({"width": 360, "height": 780})
    page.locator(".panel-events").scroll_into_view_if_needed()
    expect(page.locator(".estop")).to_be_in_viewport()


def test_help_names_the_keys(page: Page) -> None:
    page.keyboard.press("?")
    sheet = page.locator(".sheet[open]")
    expect(sheet).to_contain_text("emergency stop, always")
    page.keyboard.press("Escape")
    expect(sheet).to_have_count(0)


def test_sheets_fit_a_phone(page: Page) -> None:
    page.set_viewport_size({"width": 360, "height": 740})
    for key in ("?", "b", ",", "k"):
        page.keyboard.press(key)
        expect(page.locator(".sheet[open]")).to_have_count(1)
        assert page.evaluate("document.documentElement.scrollWidth") <= 360
        assert page.evaluate(BEYOND_THE_EDGE) == [], key
        expect(page.locator(".estop")).to_be_in_viewport()
        page.keyboard.press("Escape")


def test_from_afar_the_mode_is_written_twice_as_large(page: Page) -> None:
    size = "parseFloat(getComputedStyle(document.querySelector('.mode')).fontSize)"
    near_px = page.evaluate(size)
    page.keyboard.press("d")
    assert page.evaluate(size) >= 1.9 * near_px
    assert page.evaluate(BEYOND_THE_EDGE) == []
    expect(page.locator(".estop")).to_be_in_viewport()
