"""Without a camera: a rendered operator is opened in the console, walks where the map is pressed, and engages."""

from __future__ import annotations

import re

import pytest
from console_server import ConsoleServer, wait_for
from playwright.sync_api import Page, expect

pytestmark = pytest.mark.browser

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
