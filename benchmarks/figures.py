"""``make figures``: the console's picture for the README, the three studies and the tracker's evaluation."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from playwright.sync_api import sync_playwright

from benchmarks.bench_chain import CHROMIUM_FLAGS, chromium, server

_OUT = Path("figures")
_WORKING_AT_S = 21.5
"""Second of the bundled recording in which the operator picks."""


def console_picture(output: Path) -> None:
    """The console at 1440x900 while the bundled recording picks."""
    with server(Path("recordings/greenhouse_demo.mcap")) as (port, _), sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium(), args=CHROMIUM_FLAGS)
        page = browser.new_page(viewport={"width": 1440, "height": 900}, color_scheme="light")
        page.goto(f"http://127.0.0.1:{port}/")
        page.wait_for_timeout(_WORKING_AT_S * 1e3)
        page.screenshot(path=output)
        browser.close()


def main() -> None:
    """Everything a reader of the README may want to see again; the studies and the evaluation take minutes."""
    console_picture(Path("docs/console.png"))
    teleop = str(Path(sys.executable).with_name("teleop"))
    for study in ("tomato", "plantlet", "grape"):
        subprocess.run([teleop, "study", study, "--output", str(_OUT / study)], check=True)
    subprocess.run([teleop, "evaluate", "--output", str(_OUT / "evaluation")], check=True)


if __name__ == "__main__":
    main()
