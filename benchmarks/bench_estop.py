"""From the click on the console's stop button, in headless Chromium, to the simulated robot standing still.

The replayed operator drives the chassis meanwhile, through tracking and all; the click comes at any time between two
frames. The server is told to step and to tell its states four times as often as it does by default: the robot brakes
the same way then, but when it stands still is known to 8 ms.
"""

from __future__ import annotations

import json
import os
import random
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import httpx
from playwright.sync_api import sync_playwright
from rich.console import Console
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from benchmarks.bench_chain import CHROMIUM_FLAGS, chromium, server, session
from benchmarks.serving import quantile

LIMIT_MS = 100.0
_FINER = {"TELEOP_ENGINE__TICK_HZ": "120", "TELEOP_STREAM__STATE_HZ": "120"}
_MOVING, _STILL = 0.1, 0.005
"""Speeds of the chassis [m/s or rad/s]: driving, and standing still."""
_ARMS_STILL_RAD_S = 0.05
_PATIENCE_S = 60.0
_CLICK = """() => {
    const at = performance.timeOrigin + performance.now();
    document.querySelector("button.estop").dispatchEvent(new PointerEvent("pointerdown", { bubbles: true }));
    return at;
}"""


@dataclass(frozen=True, slots=True)
class Seen:
    """One state: the server's stamp [ms, Unix], latch, the larger of chassis speed and turning rate, joints [rad]."""

    t_ms: float
    estop: bool
    speed: float
    joints: dict[str, float]


class Watcher(threading.Thread):
    """Keeps every state of the stream."""

    def __init__(self, port: int) -> None:
        super().__init__(daemon=True)
        self._port = port
        self.states: list[Seen] = []

    def run(self) -> None:
        try:
            with connect(f"ws://127.0.0.1:{self._port}/api/v1/stream", max_size=None) as stream:
                stream.send(json.dumps({"type": "view", "image": "none", "head": False}))
                for message in stream:
                    if isinstance(message, str) and message.startswith('{"type":"state"'):
                        body = json.loads(message)
                        robot = body["robot"]
                        speed = max(abs(robot["drive_m_s"]), abs(robot["turn_rad_s"]))
                        self.states.append(Seen(body["t"] * 1e3, robot["estop"], speed, robot["joints"]))
        except ConnectionClosed:
            return

    def wait_for(self, what: str, true: Callable[[Seen], bool]) -> None:
        """Raises SystemExit when it does not come to be."""
        end_s = time.monotonic() + _PATIENCE_S
        while not (self.states and true(self.states[-1])):
            if time.monotonic() > end_s:
                raise SystemExit(f"bench: not within {_PATIENCE_S:.0f} s: {what}")
            time.sleep(0.005)

    def since(self, t_ms: float) -> list[Seen]:
        """The states from a moment on, and the one before it."""
        states = list(self.states)
        first = next((i for i, seen in enumerate(states) if seen.t_ms >= t_ms), len(states))
        return states[max(0, first - 1) :]


def main(count: float = 40.0) -> bool:
    """Print p50, p95 and the worst over several stops of a driving robot; False when p95 reaches the limit."""
    out = Console()
    if chromium() is None:
        out.print("no Chromium on this system: not measured")
        return True
    latched, standing, arms = [], [], []
    with server(session(), _FINER) as (port, _), sync_playwright() as playwright:
        api = httpx.Client(base_url=f"http://127.0.0.1:{port}/api/v1", timeout=10)
        browser = playwright.chromium.launch(executable_path=chromium(), args=CHROMIUM_FLAGS)
        page = browser.new_page(viewport={"width": 1440, "height": 900})
        page.goto(f"http://127.0.0.1:{port}/")
        page.wait_for_selector(".banner[data-estop]")
        watcher = Watcher(port)
        watcher.start()
        chance = random.Random(1)
        for number in range(int(count)):
            api.post("/estop/reset")
            api.post("/replay/seek", json={"position_s": 0.0})
            watcher.wait_for("the operator drives", lambda seen: not seen.estop and seen.speed > _MOVING)
            page.wait_for_timeout(chance.uniform(300, 600))
            clicked_ms = page.evaluate(_CLICK)
            page.wait_for_timeout(700)
            seen = watcher.since(clicked_ms)
            latched.append(_first(seen, lambda s: s.estop) - clicked_ms)
            standing.append(_last_moving(seen) - clicked_ms)
            arms.append(_arms_still(seen) - clicked_ms)
            out.print(f"stop {number + 1}: from {seen[0].speed:.2f} m/s, still after {standing[-1]:.0f} ms", end="\r")
        browser.close()
    for name, values in (("stop latched", latched), ("chassis still", standing), ("arms still", arms)):
        out.print(
            f"click to {name}: p50 {quantile(values, 0.5):.0f} ms, p95 {quantile(values, 0.95):.0f} ms, "
            f"worst {max(values):.0f} ms over {len(values)} clicks"
        )
    out.print(f"load of the machine {os.getloadavg()[0]:.1f}; limit {LIMIT_MS:g} ms")
    return max(quantile(standing, 0.95), quantile(arms, 0.95)) < LIMIT_MS


def _first(states: list[Seen], true: Callable[[Seen], bool]) -> float:
    """Stamp of the first state that is so. Raises SystemExit without one."""
    for seen in states:
        if true(seen):
            return seen.t_ms
    raise SystemExit("bench: the click did not stop the robot")


def _last_moving(states: list[Seen]) -> float:
    """Stamp of the first state from which on the chassis stands."""
    moving = max((i for i, seen in enumerate(states) if seen.speed > _STILL), default=-1)
    if moving + 1 >= len(states):
        raise SystemExit("bench: the click did not stop the robot")
    return states[max(moving + 1, 1)].t_ms


def _arms_still(states: list[Seen]) -> float:
    """Stamp of the first state from which on no joint moves."""
    still_ms = states[1].t_ms
    for before, now in pairwise(states):
        dt_s = max(1e-3, (now.t_ms - before.t_ms) * 1e-3)
        if any(abs(q - before.joints[name]) > _ARMS_STILL_RAD_S * dt_s for name, q in now.joints.items()):
            still_ms = now.t_ms
    return still_ms


if __name__ == "__main__":
    main()
