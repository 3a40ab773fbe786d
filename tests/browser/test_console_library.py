"""Recordings added from the browser, the loop switch, and what happened before the console was opened."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice
from pathlib import Path

import pytest
from console_server import RECORDING, ConsoleServer, wait_for
from playwright.sync_api import Page, expect

from robot_sim.world import World
from teleop.intent_types import Event
from teleop.recording import McapSource, McapWriter

pytestmark = pytest.mark.browser


FRAMES = 5


def short_recording(path: Path, robot_at_m: float | None = None) -> Path:
    """A few frames; robot_at_m: the robot was that far ahead, the operator engaged, and the gripper closed once."""
    source = McapSource(RECORDING)
    frames = list(islice(source.frames(0.0), FRAMES))
    source.close()
    state = replace(World().state(), base_x_m=robot_at_m) if robot_at_m is not None else None
    with McapWriter(path, frames[0].camera, source_uri="made by a test") as writer:
        for frame in frames:
            writer.write_frame(frame)
            if state is not None:
                writer.write_robot(frame.t_ns, state)
                writer.write_row(frame.t_ns, {"mode": "picking"})
        if state is not None:
            writer.write_event(Event(frames[-1].t_ns, "tool", "tool.gripper_closed"))
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


def test_a_table_is_made_and_saved(page: Page, tmp_path: Path) -> None:
    page.keyboard.press("b")
    page.locator("input[type=file]").set_input_files(short_recording(tmp_path / "for_a_table.mcap"))
    row = page.locator(".recording-row", has_text="for a table")
    row.get_by_role("button", name="Table (CSV)").click()
    job = page.locator(".job", has_text="for_a_table")
    saved = job.get_by_role("link", name="Save for_a_table.csv")
    saved.wait_for(timeout=120_000)
    with page.expect_download() as download:
        saved.click()
    lines = Path(download.value.path()).read_text(encoding="utf-8").splitlines()
    assert len(lines) == FRAMES + 1


@pytest.mark.usefixtures("demo_afterwards")
def test_the_recorded_robot_is_a_ghost_and_its_story_is_on_the_timeline(
    page: Page, server: ConsoleServer, tmp_path: Path
) -> None:
    page.keyboard.press("b")
    page.locator("input[type=file]").set_input_files(short_recording(tmp_path / "elsewhere.mcap", robot_at_m=0.7))
    page.locator(".recording", has_text="elsewhere").click()
    wait_for("it plays", lambda: server.plays("elsewhere"))
    expect(page.locator(".ghost-name[data-ghost=recorded]")).to_be_visible(timeout=60_000)
    expect(page.locator(".timeline-marks [data-family=tool]")).to_have_count(1)
    expect(page.locator(".band").first).to_be_visible()
    page.keyboard.press("b")
    page.locator(".recording", has_text="greenhouse demo").click()
    wait_for("the other one plays", lambda: server.plays("greenhouse_demo"))
    expect(page.locator(".ghost-name[data-ghost=recorded]")).to_be_hidden()


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
