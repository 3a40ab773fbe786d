"""Fruit and tanks: the server's own messages with a picked truss written in."""

from __future__ import annotations

import json
import re
from typing import Any

import cv2
import numpy as np
import pytest
from console_server import ConsoleServer, wait_for
from playwright.sync_api import Page, WebSocketRoute, expect

pytestmark = pytest.mark.browser

BEFORE_THE_EYE_M = (1.58, -1.70, 1.605)
"""From the robot's base, which the view follows."""


class Harvest:
    """Stands between server and console; while ``picked`` every red tomato hangs before the eye of the 3-D view."""

    def __init__(self) -> None:
        self.picked = False
        self.red: list[str] = []

    def route(self, socket: WebSocketRoute) -> None:
        server = socket.connect_to_server()
        socket.on_message(server.send)
        server.on_message(lambda message: socket.send(message if isinstance(message, bytes) else self.edited(message)))

    def edited(self, text: str) -> str:
        message: dict[str, Any] = json.loads(text)
        if message["type"] == "hello":
            self.red = [s["name"] for s in message["scenery"] if s["kind"] == "sphere" and s["rgba"][0] > 0.8]
        if message["type"] == "state":
            message["robot"]["tank_l"]["water"] = 0.2
            message["robot"]["fruits"] = {"a": "held", "b": "boxed", "c": "boxed+damaged"} if self.picked else {}
            x, y, z = BEFORE_THE_EYE_M
            pose = [x + message["robot"]["base"]["x"], y + message["robot"]["base"]["y"], z, 0.0, 0.0, 0.0, 1.0]
            message["robot"]["moved"] = dict.fromkeys(self.red, pose) if self.picked else {}
        return json.dumps(message)


def red_pixels(page: Page) -> int:
    png = np.frombuffer(page.locator(".scene-canvas").screenshot(), np.uint8)
    b, g, r = cv2.split(cv2.imdecode(png, cv2.IMREAD_COLOR).astype(np.int16))
    return int(((r > 110) & (r > 2 * g) & (r > 2 * b)).sum())


def test_fruit_is_counted_and_drawn_where_the_robot_says(page: Page, server: ConsoleServer) -> None:
    harvest = Harvest()
    page.route_web_socket(re.compile("/api/v1/stream"), harvest.route)
    server.post("/replay/pause")
    page.reload()
    expect(page.locator(".scene-cost")).to_have_text(re.compile(r"^\d{4,} triangles"), timeout=60_000)
    expect(page.locator('.tank[data-liquid="water"]')).to_have_attribute("data-low", "true")
    expect(page.locator('.tank[data-liquid="nutrient"]')).to_have_attribute("data-low", "false")
    before = red_pixels(page)
    harvest.picked = True
    for fate, count in (("held", "1"), ("boxed", "2"), ("dropped", "0"), ("damaged", "1")):
        expect(page.locator(f'.count[data-fate="{fate}"] b')).to_have_text(count)
    wait_for("tomatoes before the eye", lambda: red_pixels(page) > before + 1000)
    harvest.picked = False
    wait_for("tomatoes back on their plants", lambda: red_pixels(page) < before + 200)
