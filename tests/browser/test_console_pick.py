"""The assisted pick in the console: a path over the 3-D view, confirming, its stages, a fruit chosen by a click."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any

import cv2
import numpy as np
import pytest
from console_server import ConsoleServer, wait_for
from playwright.sync_api import Page, WebSocketRoute, expect

pytestmark = pytest.mark.browser


@pytest.fixture
def still(page: Page, server: ConsoleServer) -> Iterator[Page]:
    """The console with a robot at its start and nobody who could engage."""
    server.post("/replay/pause")
    server.post("/disengage")
    server.post("/run/reset")
    expect(page.locator(".scene-cost")).to_have_text(re.compile(r"^\d{4,} triangles"), timeout=60_000)
    yield page
    task = server.state()["task"]
    if task is not None and task["ended"] is None:
        server.delete(f"/tasks/{task['id']}")
    server.post("/run/reset")


def coloured(page: Page, low: tuple[int, int, int], high: tuple[int, int, int]) -> int:
    """Pixels of the 3-D view within a range of blue, green, red."""
    png = np.frombuffer(page.locator(".scene-canvas").screenshot(), np.uint8)
    picture = cv2.imdecode(png, cv2.IMREAD_COLOR)
    return int(cv2.inRange(picture, np.array(low), np.array(high)).astype(bool).sum())


def amber(page: Page) -> int:
    return coloured(page, (0, 130, 190), (110, 210, 255))


def test_the_nearest_fruit_is_previewed_confirmed_and_boxed(still: Page, server: ConsoleServer) -> None:
    before, joints = amber(still), server.state()["robot"]["joints"]
    still.get_by_role("button", name="Pick the nearest ripe fruit: show the path").click()
    card = still.locator(".pick")
    expect(card).to_have_attribute("data-task", "preview")
    expect(card.locator("strong")).to_have_text(re.compile(r"^Cucumber \d\.\d$"))
    wait_for("the path is drawn", lambda: amber(still) > before + 30)
    assert all(abs(server.state()["robot"]["joints"][j] - q) < 0.01 for j, q in joints.items()), "nothing moves yet"
    still.get_by_role("button", name="Pick it").click()
    expect(card).to_have_attribute("data-task", "running")
    expect(still.locator(".banner .reason")).to_have_text("The robot picks by itself")
    expect(card.locator('li[data-stage="approach"]')).to_have_attribute("data-at", re.compile("now|done"))
    expect(card).to_have_attribute("data-task", "succeeded")
    expect(still.locator('.count[data-fate="boxed"] b')).to_have_text("1")
    expect(card.locator(".pick-words")).to_have_text("In the box")
    wait_for("the path is gone", lambda: amber(still) < before + 30)
    events = still.locator(".panel-events")
    for words in ("Path planned Cucumber", "Pick: cut", "Peduncle cut", "Picked: the fruit is in the box"):
        expect(events).to_contain_text(words)


def test_a_fruit_is_chosen_by_a_click_and_declined(still: Page, server: ConsoleServer) -> None:
    box = still.locator(".scene-canvas").bounding_box()
    assert box is not None
    label = still.locator(".scene-label")

    def over_a_fruit() -> tuple[float, float] | None:
        for down in (0.18, 0.24, 0.30, 0.36, 0.42):
            for across in np.arange(0.62, 0.96, 0.02):
                x, y = box["x"] + across * box["width"], box["y"] + down * box["height"]
                still.mouse.move(x, y)
                if label.inner_text():
                    return x, y
        return None

    at = wait_for("a fruit under the pointer", over_a_fruit)
    name = label.inner_text()
    still.mouse.click(*at)
    card = still.locator(".pick")
    # near or far: it is previewed, or told how far to drive
    wait_for("an answer", lambda: (server.state()["task"] or {}).get("status") in ("preview", "refused"))
    if server.state()["task"]["status"] == "refused":
        expect(still.locator(".notice").last).to_contain_text(name.removesuffix(" (unripe)"))
        return
    expect(card.locator("strong")).to_have_text(name)
    still.get_by_role("button", name="End").click()
    expect(card).to_have_attribute("data-task", "cancelled")


def test_a_drag_turns_the_view_and_asks_for_nothing(still: Page, server: ConsoleServer) -> None:
    box = still.locator(".scene-canvas").bounding_box()
    assert box is not None
    before = server.state()["task"]
    still.mouse.move(box["x"] + 0.7 * box["width"], box["y"] + 0.3 * box["height"])
    still.mouse.down()
    still.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.35 * box["height"], steps=4)
    still.mouse.up()
    assert server.state()["task"] == before


class Operator:
    """Stands between server and console and writes an operator's assisted pick into the states."""

    def __init__(self) -> None:
        self.task: dict[str, Any] | None = None
        self.aim: dict[str, Any] | None = None

    def route(self, socket: WebSocketRoute) -> None:
        server = socket.connect_to_server()
        socket.on_message(server.send)
        server.on_message(lambda message: socket.send(message if isinstance(message, bytes) else self.edited(message)))

    def edited(self, text: str) -> str:
        message: dict[str, Any] = json.loads(text)
        if message["type"] == "state":
            message["task"], message["aim"] = self.task, self.aim
        return json.dumps(message)


def test_an_operator_is_told_what_their_hands_do(still: Page) -> None:
    operator = Operator()
    still.route_web_socket(re.compile("/api/v1/stream"), operator.route)
    still.reload()
    card = still.locator(".pick")
    operator.aim = {"fruit": None, "progress": 0.0}
    expect(card.locator("strong")).to_have_text("Point at a fruit")
    operator.aim = {"fruit": "cucumber_2_fruit_0", "progress": 0.6}
    expect(card.locator("strong")).to_have_text("Cucumber 3.1")
    expect(card.locator(".meter i")).to_have_attribute("style", "width:60%")
    operator.aim = None
    task = {
        "id": "a", "kind": "pick", "fruit": "cucumber_2_fruit_0", "ripe": True, "status": "preview", "stage": None,
        "progress": 0.0, "attended": True, "confirmed": False, "reason": "", "detail": "", "drive_m": 0.0,
        "forward_m": None, "created": 1.0, "started": None, "ended": None,
    }  # fmt: skip
    operator.task = task
    expect(card.locator(".pick-words")).to_contain_text("Close your left fist to start")
    expect(still.get_by_role("button", name="Pick it")).to_be_hidden()
    still.set_viewport_size({"width": 360, "height": 740})
    end = card.get_by_role("button", name="End").bounding_box()
    assert end is not None
    assert end["x"] >= 0 and end["x"] + end["width"] <= 360
    still.set_viewport_size({"width": 1280, "height": 800})
    operator.task = task | {"confirmed": True}
    expect(card.locator(".pick-words")).to_have_text("Close your right hand, too")
    operator.task = task | {"status": "running", "stage": "cut", "progress": 0.5}
    expect(card.locator(".pick-words")).to_contain_text("open one to take over")
    expect(card.locator('li[data-stage="cut"]')).to_have_attribute("data-at", "now")
    still.keyboard.press("l")
    expect(card.locator(".pick-words")).to_contain_text("双手保持握拳")
    still.keyboard.press("l")
    operator.task = task | {"status": "taken_over", "stage": "cut", "reason": "assist.hand_opened", "ended": 2.0}
    expect(card.locator(".pick-words")).to_have_text("A hand opened: you have taken over")
    expect(card.locator('li[data-stage="cut"]')).to_have_attribute("data-at", "broken")
