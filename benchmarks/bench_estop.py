"""From the click on the console's stop button, in headless Chromium, to the simulated robot standing still."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Callable

import httpx
from playwright.sync_api import sync_playwright
from rich.console import Console
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from benchmarks.bench_chain import CHROMIUM_FLAGS, chromium, server, session
from benchmarks.serving import quantile

LIMIT_MS = 100.0
_STANDING_M_S = 0.001
_CLICK = """() => {
    const at = performance.timeOrigin + performance.now();
    document.querySelector("button.estop").click();
    return at;
}"""


class Watcher(threading.Thread):
    """Keeps every state of the stream with the server's stamp [ms, Unix]."""

    def __init__(self, port: int) -> None:
        super().__init__(daemon=True)
        self._port = port
        self.states: list[tuple[float, bool, float]] = []
        """Stamp, e-stop latched, the larger of speed [m/s] and turning rate [rad/s]."""

    def run(self) -> None:
        try:
            with connect(f"ws://127.0.0.1:{self._port}/api/v1/stream", max_size=None) as stream:
                stream.send(json.dumps({"type": "view", "image": "none", "head": False}))
                for message in stream:
                    if isinstance(message, str) and message.startswith('{"type":"state"'):
                        body = json.loads(message)
                        robot = body["robot"]
                        speed = max(abs(robot["drive_m_s"]), abs(robot["turn_rad_s"]))
                        self.states.append((body["t"] * 1e3, robot["estop"], speed))
        except ConnectionClosed:
            return

    def first(self, after_ms: float, true: Callable[[bool, float], bool]) -> float | None:
        """Stamp of the first state after a moment that is so."""
        return next((t for t, estop, speed in self.states if t >= after_ms and true(estop, speed)), None)


def main(count: float = 20.0) -> bool:
    """Print p50, p95 and the worst over several stops while the chassis drives; False when one reaches the limit."""
    out = Console()
    if chromium() is None:
        out.print("no Chromium on this system: not measured")
        return True
    latched, standing = [], []
    with server(session()) as (port, _), sync_playwright() as playwright:
        api = httpx.Client(base_url=f"http://127.0.0.1:{port}/api/v1", timeout=10)
        browser = playwright.chromium.launch(executable_path=chromium(), args=CHROMIUM_FLAGS)
        page = browser.new_page(viewport={"width": 1440, "height": 900})
        page.goto(f"http://127.0.0.1:{port}/")
        page.wait_for_selector("button.estop")
        watcher = Watcher(port)
        watcher.start()
        page.wait_for_timeout(5_000)
        api.post("/replay/pause")  # nobody is engaged then, and the API may drive
        for _ in range(int(count)):
            api.post("/disengage")
            _drive(api, watcher)
            clicked_ms = page.evaluate(_CLICK)
            page.wait_for_timeout(600)
            stop_ms = watcher.first(clicked_ms, lambda estop, _: estop)
            still_ms = watcher.first(clicked_ms, lambda estop, speed: estop and speed < _STANDING_M_S)
            if stop_ms is None or still_ms is None:
                raise SystemExit("bench: the click did not stop the robot")
            latched.append(stop_ms - clicked_ms)
            standing.append(still_ms - clicked_ms)
            api.post("/estop/reset")
            page.wait_for_timeout(200)
        browser.close()
    for name, values in (("stop latched in the state", latched), ("chassis stands still", standing)):
        out.print(
            f"click to {name}: p50 {quantile(values, 0.5):.0f} ms, p95 {quantile(values, 0.95):.0f} ms, "
            f"worst {max(values):.0f} ms over {len(values)} clicks"
        )
    out.print(f"by the stamps of states, so up to one state's interval late; limit {LIMIT_MS:g} ms")
    return max(standing) < LIMIT_MS


def _drive(api: httpx.Client, watcher: Watcher) -> None:
    """Ask for speed until the chassis has it. Raises SystemExit when it does not move."""
    end_s = time.monotonic() + 10.0
    while time.monotonic() < end_s:
        api.post("/robot/command", json={"drive_m_s": 0.3, "for_s": 1.0})
        time.sleep(0.15)
        if watcher.states and watcher.states[-1][2] > 0.1 and not watcher.states[-1][1]:
            return
    raise SystemExit("bench: the robot did not drive")


if __name__ == "__main__":
    main()
