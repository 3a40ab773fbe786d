"""Recordings added from the browser, the loop switch, and what happened before the console was opened."""

from __future__ import annotations

from itertools import islice
from pathlib import Path

import pytest
from console_server import RECORDING, ConsoleServer, wait_for
from playwright.sync_api import Page, expect

from teleop.recording import McapSource, McapWriter

pytestmark = pytest.mark.browser


def short_recording(path: Path) -> Path:
    source = McapSource(RECORDING)
    frames = list(islice(source.frames(0.0), 5))
    source.close()
    with McapWriter(path, frames[0].camera, source_uri="made by a test") as writer:
        for frame in frames:
            writer.write_frame(frame)
    return path


def test_a_recording_is_added_from_the_browser(page: Page, tmp_path: Path) -> None:
    page.get_by_role("button", name="Recordings").click()
    page.locator(".recording").first.wait_for()
    page.locator("input[type=file]").set_input_files(short_recording(tmp_path / "from_the_browser.mcap"))
    expect(page.locator(".recording", has_text="from the browser")).to_be_visible(timeout=20_000)


def test_what_is_no_recording_is_refused_in_words(page: Page, tmp_path: Path, logged: list[str]) -> None:
    wrong = tmp_path / "wrong.mcap"
    wrong.write_bytes(b"no recording")
    page.get_by_role("button", name="Recordings").click()
    page.locator("input[type=file]").set_input_files(wrong)
    expect(page.locator(".notice").first).to_contain_text("Refused")
    logged[:] = [text for text in logged if "422" not in text]


def test_the_loop_is_switched(page: Page, server: ConsoleServer) -> None:
    loop = page.get_by_role("button", name="Play in a loop")
    expect(loop).to_have_attribute("aria-pressed", "true")
    loop.click()
    wait_for("the loop is off", lambda: not server.state()["source"]["loop"])
    expect(loop).to_have_attribute("aria-pressed", "false")
    page.keyboard.press("o")
    wait_for("the loop is on", lambda: server.state()["source"]["loop"])


def test_events_from_before_are_listed_once_and_marked(page: Page, server: ConsoleServer) -> None:
    server.post("/estop")
    server.post("/estop/reset")
    expect(page.locator('.events li[data-reason="mode.estop_reset"]').first).to_be_visible()
    page.reload()
    page.locator(".link[data-link=open]").wait_for(timeout=20_000)
    expect(page.locator('.events li[data-reason="stop.estop"]').first).to_be_visible()
    expect(page.locator('.timeline-marks [data-family="stop"]').first).to_be_attached()
