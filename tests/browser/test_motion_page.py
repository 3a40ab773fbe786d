"""The page that plays the studies' motions: alone, with a motion, and scanned by axe-core."""

from __future__ import annotations

import numpy as np
import pytest
from console_server import ROOT, ConsoleServer, wait_for
from playwright.sync_api import Page, expect

from robot_sim.arms.tomato import tomato_arm
from robot_sim.arms.urdf_writer import ArmModel, limbs_of, write_urdf
from robot_sim.studies.motion_file import write_motion

pytestmark = pytest.mark.browser

SERIOUS = """async () => (await axe.run()).violations
  .filter(v => v.impact === 'serious' || v.impact === 'critical').map(v => v.id + ' ' + v.nodes[0].target)"""
AXE = ROOT / "web" / "node_modules" / "axe-core" / "axe.min.js"


def test_a_motion_plays(page: Page, server: ConsoleServer) -> None:
    chain = tomato_arm().chain
    q = np.linspace(0.0, 0.5, 40)[:, None] * np.ones(5)
    server.studies.mkdir(exist_ok=True)
    urdf = write_urdf(ArmModel(chain, limbs_of(chain, 0.03), ()))
    write_motion(server.studies / "tomato.mcap", urdf, chain, np.arange(40) * 0.1, q, solids=[])
    page.goto(f"{server.url}motion.html?id=tomato")
    slider = page.locator("footer input[type=range]")
    wait_for("the motion plays", lambda: float(slider.input_value()) > 0.2)
    for width in (360, 1440):
        page.set_viewport_size({"width": width, "height": 800})
        assert page.evaluate("document.documentElement.scrollWidth") <= width
    if AXE.is_file():
        page.evaluate(AXE.read_text(encoding="utf-8"))
        assert page.evaluate(SERIOUS) == []


def test_an_unknown_motion_is_said_in_words(page: Page, server: ConsoleServer, logged: list[str]) -> None:
    page.goto(f"{server.url}motion.html?id=nothing")
    expect(page.locator("main")).to_contain_text("nothing")
    logged[:] = [text for text in logged if "404" not in text]
