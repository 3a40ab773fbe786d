"""The console after a reload and after the server was away."""

from __future__ import annotations

import pytest
from console_server import ConsoleServer
from playwright.sync_api import Page, expect

pytestmark = pytest.mark.browser


def test_reload_in_the_middle_recovers(page: Page, server: ConsoleServer) -> None:
    server.post("/estop")
    expect(page.locator(".banner")).to_have_attribute("data-estop", "true")
    page.reload()
    page.locator(".link[data-link=open]").wait_for(timeout=20_000)
    expect(page.locator(".banner")).to_have_attribute("data-estop", "true")
    expect(page.locator(".gone")).to_be_hidden()


def test_console_tells_of_a_lost_server_and_recovers(page: Page, server: ConsoleServer, logged: list[str]) -> None:
    expect(page.locator(".gone")).to_be_hidden()
    assert server.stop() == 0
    expect(page.locator(".gone")).to_be_visible(timeout=15_000)
    expect(page.locator(".link")).to_have_attribute("data-link", "lost")
    page.keyboard.press("Space")  # a stop that cannot be delivered is not swallowed
    expect(page.locator(".notice").first).to_be_visible(timeout=15_000)
    server.start()
    page.locator(".link[data-link=open]").wait_for(timeout=20_000)
    expect(page.locator(".gone")).to_be_hidden()
    refused = "net::ERR_CONNECTION_REFUSED"
    assert any(refused in text for text in logged)
    logged[:] = [text for text in logged if refused not in text]
