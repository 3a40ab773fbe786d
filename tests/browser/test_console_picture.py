"""What is drawn over the picture and on the crop, on demand only; tones; recording from the console."""

from __future__ import annotations

import json
import re

import cv2
import numpy as np
import pytest
from console_server import ConsoleServer, wait_for
from playwright.sync_api import Page, WebSocketRoute, expect

from server.images_wire import ImageKind, ImagePacket

pytestmark = pytest.mark.browser

BLUE_IS_WET = (0.0, 0.0, 1.0)
COUNT_TONES = """window.tones = 0; const create = AudioContext.prototype.createOscillator;
AudioContext.prototype.createOscillator = function () { window.tones++; return create.call(this); };"""


class Wire:
    """Stands between server and console: counts the pictures of body parts, and wets every leaf when told to."""

    def __init__(self) -> None:
        self.parts = 0
        self.wet = False
        self.leaves: list[str] = []

    def route(self, socket: WebSocketRoute) -> None:
        server = socket.connect_to_server()
        socket.on_message(server.send)

        def pass_on(message: str | bytes) -> None:
            if isinstance(message, bytes):
                self.parts += ImagePacket.from_bytes(message).kind is ImageKind.PARTS
            elif message.startswith('{"type":"hello"'):
                names = [item["name"] for item in json.loads(message)["scenery"]]
                self.leaves = [re.sub("_(lobe|pair)$", "", name) for name in names if "_leaf_" in name]
            elif message.startswith('{"type":"state"') and self.wet:
                socket.send(json.dumps({"type": "coverage", "wet": dict.fromkeys(self.leaves, BLUE_IS_WET)}))
            socket.send(message)

        server.on_message(pass_on)


def orange_pixels(page: Page) -> int:
    png = np.frombuffer(page.locator(".scene-canvas").screenshot(), np.uint8)
    b, g, r = cv2.split(cv2.imdecode(png, cv2.IMREAD_COLOR).astype(np.int16))
    return int(((r > g) & (g > b + 30) & (r > 90)).sum())


def test_parts_come_only_while_asked_for_and_wet_leaves_take_their_liquids_colour(page: Page) -> None:
    wire = Wire()
    page.route_web_socket(re.compile("/api/v1/stream"), wire.route)
    page.reload()
    expect(page.locator(".scene-cost")).to_have_text(re.compile(r"^\d{4,} triangles"), timeout=60_000)
    assert wire.parts == 0
    page.keyboard.press("n")
    wait_for("body parts come", lambda: page.wait_for_timeout(50) or wire.parts > 2)
    colours = "c => new Set(new Uint32Array(c.getContext('2d').getImageData(0, 0, c.width, c.height).data.buffer)).size"
    wait_for("parts are drawn", lambda: page.locator("canvas.parts").evaluate(colours) > 5)
    page.keyboard.press("n")
    page.wait_for_timeout(500)
    seen = wire.parts
    page.wait_for_timeout(700)
    assert wire.parts == seen
    dry = orange_pixels(page)
    wire.wet = True
    wait_for("wet leaves", lambda: orange_pixels(page) > dry + 3000)


def test_a_stop_is_heard(page: Page, server: ConsoleServer) -> None:
    page.add_init_script(COUNT_TONES)
    page.reload()
    page.locator(".banner[data-estop]").wait_for(timeout=20_000)
    page.locator(".estop").click()
    wait_for("a tone", lambda: page.evaluate("window.tones") > 0)
    page.keyboard.press("s")
    page.wait_for_timeout(300)
    before = page.evaluate("window.tones")
    server.post("/estop/reset")
    expect(page.locator(".banner")).to_have_attribute("data-estop", "false")
    assert page.evaluate("window.tones") == before


def recording(server: ConsoleServer) -> bool | None:
    """Whether the session is being recorded; None between two sessions."""
    source = server.state()["source"]
    return None if source is None else bool(source["recording"])


def test_a_session_is_recorded_and_is_in_the_library(page: Page, server: ConsoleServer) -> None:
    page.keyboard.press("r")
    wait_for("recording", lambda: recording(server) is True)
    expect(page.locator(".record")).to_have_attribute("aria-pressed", "true")
    page.wait_for_timeout(1500)
    page.keyboard.press("r")
    wait_for("no longer recording", lambda: recording(server) is False)
    page.keyboard.press("b")
    expect(page.locator(".recording-row").nth(1)).to_be_visible()


def test_marks_of_the_timeline_tell_what_happened(page: Page, server: ConsoleServer) -> None:
    server.post("/estop")
    server.post("/estop/reset")
    mark = page.locator('.timeline-marks [data-family="stop"]').first
    expect(mark).to_be_attached()
    box = mark.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 1, box["y"] + box["height"] / 2)
    expect(page.locator(".timeline-tip b")).to_have_text(re.compile(r"^\d+:\d\d$"))
    expect(page.locator(".timeline-tip span").first).to_be_visible()
