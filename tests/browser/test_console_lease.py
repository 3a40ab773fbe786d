"""Two consoles and one robot: the lease is handed over, a viewer only watches, the stop is everybody's."""

from __future__ import annotations

import pytest
from conftest import open_console
from console_server import ConsoleServer, wait_for
from playwright.sync_api import Browser, Page, expect

pytestmark = pytest.mark.browser

KEY = """async path => (await fetch('/api/v1' + path, { method: 'POST', headers: {
  'X-Teleop-Client': sessionStorage.getItem('greenhouse-client') } })).status"""


def test_the_lease_is_handed_over_and_everybody_may_stop(
    page: Page, browser: Browser, server: ConsoleServer, logged: list[str]
) -> None:
    expect(page.locator(".round[aria-pressed=true]")).to_have_count(1)
    page.keyboard.press("o")
    expect(page.locator(".lease")).to_have_attribute("data-standing", "mine")
    wait_for("the loop is off", lambda: not server.state()["source"]["loop"])
    expect(page.locator(".round[aria-pressed=true]")).to_have_count(0)
    page.keyboard.press("o")
    wait_for("the loop is on again", lambda: server.state()["source"]["loop"])
    other = open_console(browser, server, logged, key="another-console-of-the-tests")
    try:
        expect(other.locator(".lease")).to_have_attribute("data-standing", "theirs")
        assert other.locator(".actions").evaluate("e => e.inert")
        assert other.evaluate(KEY, "/engage") == 423
        other.keyboard.press("Space")  # stopping needs no lease
        wait_for("stopped by the console without the lease", lambda: server.state()["robot"]["estop"])
        other.get_by_role("button", name="Ask for control").click()
        expect(page.locator(".ask")).to_contain_text("asks for control")
        page.locator(".ask").get_by_role("button", name="Hand over").click()
        expect(other.locator(".lease")).to_have_attribute("data-standing", "mine")
        expect(page.locator(".lease")).to_have_attribute("data-standing", "theirs")
        other.keyboard.press("Shift+R")
        wait_for("reset by the new holder", lambda: not server.state()["robot"]["estop"])
        other.locator(".lease").get_by_role("button", name="Hand over").click()
        expect(page.locator(".lease")).to_have_attribute("data-standing", "free")
    finally:
        other.evaluate(KEY, "/lease/release")
        other.context.close()
    logged[:] = [text for text in logged if "423" not in text]


def test_a_viewer_sees_everything_and_commands_nothing_but_the_stop(
    page: Page, server: ConsoleServer, logged: list[str]
) -> None:
    page.get_by_role("button", name="Who you are").click()
    page.locator("#token").fill("gt_viewer_wrong")
    page.get_by_role("button", name="Sign in").click()
    expect(page.locator(".sheet[open] .bad")).to_contain_text("token")
    page.locator("#token").fill(server.token("viewer"))
    page.get_by_role("button", name="Sign in").click()
    expect(page.locator(".lease")).to_have_attribute("data-standing", "viewer")
    expect(page.locator(".link")).to_have_attribute("data-link", "open")
    assert page.locator(".actions").evaluate("e => e.inert")
    looping = server.state()["source"]["loop"]
    page.keyboard.press("o")
    page.keyboard.press("e")
    assert page.evaluate(KEY, "/engage") == 403
    assert server.state()["source"]["loop"] == looping
    page.keyboard.press("Space")
    wait_for("stopped by a viewer", lambda: server.state()["robot"]["estop"])
    page.get_by_role("button", name="Who you are").click()
    page.get_by_role("button", name="Sign out").click()
    expect(page.locator(".lease")).not_to_have_attribute("data-standing", "viewer")
    logged[:] = [text for text in logged if "403" not in text and "401" not in text]
