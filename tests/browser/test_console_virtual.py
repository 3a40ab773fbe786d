"""Without a camera: a rendered operator is opened in the console, walks where the map is pressed, and engages."""

from __future__ import annotations

import re

import pytest
from console_server import ConsoleServer, wait_for
from playwright.sync_api import Page, expect

pytestmark = pytest.mark.browser

MARK_BEYOND_MAP = """() => {
  const map = document.querySelector('.floor-map'), at = map.getScreenCTM(), view = map.viewBox.baseVal;
  const mark = document.querySelector('.floor-dot').getBoundingClientRect();
  return Math.max(0, mark.right - (at.e + at.a * (view.x + view.width)), at.e + at.a * view.x - mark.left);
}"""
"""By how many pixels the operator's mark leaves the floor map to the side."""
LONG_S = 120.0
"""They walk and are tracked as fast as the machine renders them."""


@pytest.fixture
def virtual(page: Page, demo_afterwards: None) -> Page:
    """The console with the virtual operator."""
    page.keyboard.press("b")
    page.get_by_role("button", name="Try it without a camera").click()
    expect(page.locator(".panel-puppet")).to_be_visible()
    return page


def test_a_virtual_operator_is_driven_from_the_console(virtual: Page, server: ConsoleServer) -> None:
    expect(virtual.locator(".source-badge")).to_have_text("Virtual")
    wait_for("they are seen", lambda: server.state()["spine_xz"], LONG_S)
    box = virtual.locator('.floor-zone[data-zone="right"]').bounding_box()
    assert box is not None
    virtual.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    wait_for("they stand in the right zone", lambda: server.state()["zone"] == "right", LONG_S)
    side = virtual.locator(".puppet-arm").first.get_by_role("slider").first
    side.evaluate("e => { e.value = 60; e.dispatchEvent(new Event('input')); }")
    wait_for("the arm is raised", lambda: (server.state()["angles"]["theta1_right"] or 0.0) > 45.0, LONG_S)
    virtual.get_by_role("button", name="Hands beside the head").click()
    wait_for("the gesture counts", lambda: server.state()["engage_progress"] > 0.0, LONG_S)
    expect(virtual.locator(".panel-replay")).to_have_attribute("data-live", re.compile("true"))


def test_who_stands_beside_the_map_is_drawn_at_its_edge(virtual: Page, server: ConsoleServer) -> None:
    virtual.set_viewport_size({"width": 360, "height": 740})
    wait_for("they are seen", lambda: server.state()["spine_xz"], LONG_S)
    virtual.locator(".floor-map").scroll_into_view_if_needed()
    box = virtual.locator(".floor-map").bounding_box()
    assert box is not None
    virtual.mouse.click(box["x"] + box["width"] - 3, box["y"] + 0.8 * box["height"])
    wait_for("they stand at the edge", lambda: (server.state()["spine_xz"] or [0.0])[0] > 1.25, LONG_S)
    virtual.wait_for_timeout(300)
    assert virtual.evaluate(MARK_BEYOND_MAP) == 0
