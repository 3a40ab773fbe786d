"""An operator at the console: what is shown follows the recording, and every control reaches the robot."""

from __future__ import annotations

import re
from typing import Any

import pytest
from console_server import ConsoleServer, wait_for
from playwright.sync_api import Page, expect

pytestmark = pytest.mark.browser

ONE_PASS_S = 240.0
ARM_JOINT = re.compile(r"(right|left|rear)_(c1|c2|elbow)")
MOVED_RAD = 0.15


def arms(state: dict[str, Any]) -> dict[str, float]:
    return {name: value for name, value in state["robot"]["joints"].items() if ARM_JOINT.fullmatch(name)}


def drive_while_nobody_is_engaged(server: ConsoleServer) -> None:
    """Drives the robot by the API at the recording's start, where nobody has engaged; returns once it moves."""
    server.post("/replay/seek", {"position_s": 0.0})

    def moving() -> bool:
        server.post("/robot/command", {"drive_m_s": 0.3, "for_s": 1.0})
        return bool(server.state()["robot"]["drive_m_s"] > 0.1)

    wait_for("the robot drives when the API asks for it", moving)


def is_stopped(server: ConsoleServer) -> bool:
    robot = server.state()["robot"]
    return robot["estop"] and robot["drive_m_s"] == 0.0 and robot["turn_rad_s"] == 0.0


def test_banner_and_robot_follow_the_recorded_person(page: Page, server: ConsoleServer) -> None:
    server.post("/replay/seek", {"position_s": 0.0})
    first = arms(server.state())
    modes: set[str] = set()
    farthest = 0.0

    def story_told() -> bool:
        nonlocal farthest
        modes.add(page.locator(".banner").get_attribute("data-mode") or "")
        now = arms(server.state())
        farthest = max(farthest, *(abs(now[name] - first[name]) for name in first))
        return {"forward", "picking", "spraying"} <= modes and farthest > MOVED_RAD

    try:
        wait_for("the banner shows the story's modes and the arms move", story_told, ONE_PASS_S)
    except AssertionError as error:
        raise AssertionError(f"{error}; modes {sorted(modes)}, largest arm motion {farthest:.2f} rad") from None
    expect(page.locator(".events li").first).to_have_attribute("data-reason", re.compile(r".+\..+"))


def test_robot_is_drawn_within_the_triangle_budget(page: Page) -> None:
    cost = page.locator(".scene-cost")
    expect(cost).to_have_text(re.compile(r"^\d{4,} triangles"), timeout=60_000)  # the empty stage comes first
    assert int((cost.text_content() or "").split()[0]) <= 15_000


def is_painted(page: Page, canvas: str) -> bool:
    """Whether a canvas shows a picture with some contrast."""
    return bool(
        page.locator(canvas).evaluate(
            """canvas => {
              const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
              let low = 255, high = 0;
              for (let i = 0; i < data.length; i += 40) {
                low = Math.min(low, data[i]);
                high = Math.max(high, data[i]);
              }
              return high - low > 60;
            }"""
        )
    )


def test_depth_colour_and_head_pictures_arrive(page: Page) -> None:
    wait_for("the depth picture", lambda: is_painted(page, ".picture"))
    page.get_by_role("button", name="Off", exact=True).click()
    assert not is_painted(page, ".picture")
    page.keyboard.press("v")
    expect(page.get_by_role("button", name="Depth", exact=True)).to_have_attribute("aria-pressed", "true")
    page.get_by_role("button", name="Colour", exact=True).click()
    wait_for("the colour picture", lambda: is_painted(page, ".picture"))
    assert not is_painted(page, ".head-picture")
    page.get_by_role("button", name="Head camera", exact=True).click()
    wait_for("the head camera's picture", lambda: is_painted(page, ".head-picture"))


def test_overlay_is_acknowledged(page: Page, server: ConsoleServer) -> None:
    total = wait_for("a measured time from frame to painted overlay", lambda: server.state()["latency_ms"].get("total"))
    assert total["p50"] > 0
    expect(page.locator(".total-value").first).to_have_text(re.compile(r"\d"))


def test_space_bar_stops_the_moving_robot(page: Page, server: ConsoleServer) -> None:
    drive_while_nobody_is_engaged(server)
    page.locator(".panel-replay select").focus()  # the space bar stops wherever the focus is
    page.keyboard.press("Space")
    wait_for("emergency stop, chassis at rest", lambda: is_stopped(server))
    expect(page.locator(".banner")).to_have_attribute("data-estop", "true")
    expect(page.locator(".mode")).to_have_text("Emergency stop")
    at_rest = server.state()["robot"]["base"]
    server.post("/robot/command", {"drive_m_s": 0.3, "for_s": 1.0})
    page.wait_for_timeout(500)
    state = server.state()["robot"]
    assert state["estop"]
    assert state["base"] == pytest.approx(at_rest, abs=0.005)


def test_button_stops_the_moving_robot_and_reset_releases_it(page: Page, server: ConsoleServer) -> None:
    reset = page.get_by_role("button", name=re.compile("Reset the emergency stop"))
    expect(reset).to_be_disabled()
    page.keyboard.press("?")  # an open sheet does not cover the button
    drive_while_nobody_is_engaged(server)
    page.locator(".estop").click()
    page.keyboard.press("Escape")
    wait_for("emergency stop, chassis at rest", lambda: is_stopped(server))
    expect(page.locator(".events li[data-family=stop]").first).to_be_visible()
    reset.click()
    wait_for("the emergency stop is released", lambda: not server.state()["robot"]["estop"])
    expect(page.locator(".banner")).to_have_attribute("data-estop", "false")


def test_pause_and_seek(page: Page, server: ConsoleServer) -> None:
    page.keyboard.press("p")
    wait_for("paused", lambda: server.state()["source"]["paused"])
    slider = page.get_by_role("slider", name="Position")
    slider.evaluate("e => { e.value = 12; e.dispatchEvent(new Event('input')); e.dispatchEvent(new Event('change')); }")
    wait_for("sought to 12 s", lambda: abs(server.state()["source"]["position_s"] - 12.0) < 0.5)
    expect(page.locator(".transport output")).to_have_text(re.compile(r"^0:1[12] / "))
    page.get_by_role("button", name=re.compile("Play or pause")).click()
    wait_for("playing on", lambda: not server.state()["source"]["paused"])


def test_speed_and_lift_reach_the_robot(page: Page, server: ConsoleServer) -> None:
    page.get_by_role("combobox", name="Speed").select_option("0.5")
    wait_for("half speed", lambda: server.state()["source"]["speed"] == 0.5)
    page.keyboard.press("]")
    wait_for("full speed", lambda: server.state()["source"]["speed"] == 1.0)
    lift = page.locator(".drive input").first
    low, high = (float(lift.get_attribute(side) or "nan") for side in ("min", "max"))
    goal = low + 0.6 * (high - low)
    lift.evaluate(f"e => {{ e.value = {goal}; e.dispatchEvent(new Event('change')); }}")
    wait_for("the lift arrives", lambda: abs(server.state()["robot"]["joints"]["lift"] - goal) < 0.02)


def test_recording_is_chosen_from_the_library(page: Page, server: ConsoleServer) -> None:
    page.get_by_role("button", name="Recordings").click()
    page.locator(".recording", has_text="greenhouse demo").click()
    expect(page.locator(".sheet[open]")).to_have_count(0)
    wait_for("the library's recording plays", lambda: server.plays("greenhouse_demo"))


def test_language_and_theme_switch(page: Page) -> None:
    expect(page.locator(".estop span")).to_have_text("STOP")
    page.keyboard.press("l")
    expect(page.locator(".estop span")).to_have_text("急停")
    expect(page.locator("html")).to_have_attribute("lang", "zh-CN")
    page.keyboard.press("t")
    expect(page.locator("html")).to_have_attribute("data-theme", "light")
    page.reload()
    expect(page.locator(".estop span")).to_have_text("急停")
