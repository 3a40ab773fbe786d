"""Settings from the configuration's schema, a replay with others, and the calibration that keeps the robot still."""

from __future__ import annotations

from typing import Any

import pytest
from console_server import ConsoleServer, wait_for
from playwright.sync_api import Locator, Page, expect

pytestmark = pytest.mark.browser

L1 = "teleop.intent.zones.l1_m"


def zones(server: ConsoleServer) -> dict[str, Any]:
    return dict(server.config()["teleop"]["intent"]["zones"])


def field(page: Page, path: str) -> Locator:
    page.locator(".setting").first.wait_for(state="attached")
    page.get_by_role("searchbox").fill(path)
    return page.locator(f'[data-path="{path}"]')


def patch(page: Page, intent: dict[str, Any]) -> None:
    """Change settings as the console's own client."""
    page.evaluate(
        """patch => fetch('/api/v1/config', { method: 'PATCH', body: JSON.stringify(patch), headers: {
          'Content-Type': 'application/json', 'X-Teleop-Client': sessionStorage.getItem('greenhouse-client') } })""",
        {"teleop": {"intent": intent}},
    )


def test_a_refused_value_is_told_at_its_field_and_the_running_one_stays(
    page: Page, server: ConsoleServer, logged: list[str]
) -> None:
    page.keyboard.press(",")
    row = field(page, L1)
    expect(row).to_contain_text("0.4 – 5 m")
    row.locator("input").fill("9")
    page.get_by_role("button", name="Apply").click()
    expect(row.locator(".setting-refusal")).to_contain_text("less than or equal to 5")
    expect(row.locator(".setting-refusal")).to_contain_text("In force: 1.4")
    assert zones(server)["l1_m"] == 1.4
    row.locator("input").fill("1.5")
    page.get_by_role("button", name="Apply").click()
    wait_for("the new value is in force", lambda: zones(server)["l1_m"] == 1.5)
    expect(row.locator(".setting-refusal")).to_be_empty()
    row.get_by_role("button", name="Back to the default").click()
    page.get_by_role("button", name="Apply").click()
    wait_for("the default is in force", lambda: zones(server)["l1_m"] == 1.4)
    logged[:] = [text for text in logged if "422" not in text]


def test_settings_and_steps_that_were_not_open_follow_the_language_too(page: Page, server: ConsoleServer) -> None:
    page.keyboard.press("l")
    page.keyboard.press(",")
    page.locator(".setting").first.wait_for(state="attached")
    page.get_by_role("searchbox").fill("l1_m")
    expect(page.locator(f'[data-path="{L1}"] .setting-about')).to_contain_text("深度")
    page.keyboard.press("Escape")
    page.keyboard.press("k")
    expect(page.locator(".sheet[open] .gauge small").first).to_have_text("高度")
    page.keyboard.press("Escape")
    wait_for("the emergency stop is latched", lambda: server.state()["robot"]["estop"])


def test_what_if_replays_with_other_settings_and_goes_back(page: Page, server: ConsoleServer) -> None:
    page.keyboard.press("b")
    page.locator(".recording-row", has_text="greenhouse demo").get_by_role("button", name="What if").click()
    field(page, L1).locator("input").fill("1.2")
    page.get_by_role("button", name="Replay with these").click()
    expect(page.locator(".whatif")).to_contain_text("1 other settings")
    wait_for(
        "the recording plays from its start",
        lambda: (server.state()["source"] or {"position_s": 9.0})["position_s"] < 5.0,
    )
    assert zones(server)["l1_m"] == 1.2
    page.reload()
    page.get_by_role("button", name="Back to before").click()
    wait_for("the settings before are in force", lambda: zones(server)["l1_m"] == 1.4)
    expect(page.locator(".whatif")).to_be_hidden()


def test_the_robot_does_not_move_while_the_sensor_is_calibrated(page: Page, server: ConsoleServer) -> None:
    server.post("/replay/seek", {"position_s": 28.0})
    page.keyboard.press("k")
    wait_for("the emergency stop is latched", lambda: server.state()["robot"]["estop"])
    page.get_by_role("button", name="Use this tilt").click(timeout=90_000)
    level = wait_for("a tilt is kept", lambda: server.config()["teleop"]["intent"]["level"]["tilt_deg"] or None)
    assert level == pytest.approx(-2.0, abs=0.5)
    page.get_by_role("button", name="Next", exact=True).click()
    # the operator of the recording stands about where the default zones are: what is set must not be what was
    patch(page, {"zones": {"l1_m": 1.0}})
    page.get_by_role("button", name="I work here").click(timeout=90_000)
    wait_for("the zones lie round the operator", lambda: abs(zones(server)["l1_m"] - 1.4) < 0.2)
    page.get_by_role("button", name="Next", exact=True).click()
    expect(page.locator(".hand-check[data-passed]")).not_to_have_count(0, timeout=30_000)
    page.get_by_role("button", name="Next", exact=True).click()
    expect(page.locator(".sheet[open] li", has_text="Zones begin")).to_be_visible()
    assert server.state()["robot"]["estop"]
    page.get_by_role("button", name="Reset the emergency stop and finish").click()
    wait_for("the emergency stop is released", lambda: not server.state()["robot"]["estop"])
    expect(page.locator(".sheet[open]")).to_have_count(0)
    patch(page, {"zones": {"l1_m": 1.4}, "level": {"tilt_deg": 0.0}})
    wait_for("the settings before are in force", lambda: zones(server)["l1_m"] == 1.4)
