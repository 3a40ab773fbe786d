"""One server and one Chromium for all browser tests; every page fails its test when it logs an error."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from console_server import ROOT, ConsoleServer, wait_for
from playwright.sync_api import Browser, ConsoleMessage, Page, expect, sync_playwright

CLIENT_KEY = "the-browser-tests"
"""All tests are one client to the server, so that none waits for the lease of the one before."""
CHROMIUM_NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
# Software rendering everywhere: the tests see the same picture with and without a GPU. No calls to anybody outside.
FLAGS = (
    "--no-sandbox",
    "--disable-gpu",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
)


PATIENCE_MS = 30_000
"""A machine that is busy with other things is not a fault of the console."""
expect.set_options(timeout=PATIENCE_MS)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Browser tests come last: Playwright's event loop stays in this thread, where asyncio.run is then refused."""
    items.sort(key=lambda item: item.path.is_relative_to(Path(__file__).parent))


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        system = next((path for name in CHROMIUM_NAMES if (path := shutil.which(name))), None)
        own = Path(playwright.chromium.executable_path)
        if system is None and not own.exists():
            pytest.skip("no Chromium here: apt install chromium, or .venv/bin/playwright install chromium")
        chromium = playwright.chromium.launch(executable_path=system or str(own), args=list(FLAGS))
        yield chromium
        chromium.close()


@pytest.fixture(scope="session")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ConsoleServer]:
    if not (ROOT / "server" / "console" / "index.html").is_file():
        pytest.skip("the console is not built: make setup")
    server = ConsoleServer(tmp_path_factory.mktemp("console"))
    try:
        server.start()
        yield server
    finally:
        server.stop()


def open_console(browser: Browser, server: ConsoleServer, logged: list[str], key: str = CLIENT_KEY) -> Page:
    """A console of its own, connected; errors that it logs go to ``logged``. key: by which the server knows it."""
    context = browser.new_context(viewport={"width": 1440, "height": 900}, locale="en-GB", color_scheme="dark")
    context.add_init_script(f"sessionStorage.setItem('greenhouse-client', '{key}')")
    page = context.new_page()

    def note(message: ConsoleMessage) -> None:
        if message.type == "error":
            logged.append(message.text)

    page.on("console", note)
    page.on("pageerror", lambda error: logged.append(str(error)))
    page.goto(server.url)
    page.locator(".link[data-link=open]").wait_for(timeout=20_000)
    page.locator(".banner[data-estop]").wait_for(timeout=20_000)  # a key means nothing before the first state
    return page


@pytest.fixture
def logged(server: ConsoleServer) -> list[str]:
    """Errors that the page logged; a test that expects some takes them out."""
    return []


@pytest.fixture
def page(browser: Browser, server: ConsoleServer, logged: list[str]) -> Iterator[Page]:
    """The console, connected, at 1440x900, with the emergency stop released before and after."""
    server.post("/estop/reset")
    server.post("/replay/play")
    page = open_console(browser, server, logged)
    yield page
    page.context.close()
    server.post("/estop/reset")
    server.post("/replay/play")
    assert logged == []


@pytest.fixture
def demo_afterwards(page: Page, server: ConsoleServer) -> Iterator[None]:
    """Whatever a test plays and however it ends, the next one finds the bundled recording and a free lease."""
    yield
    page.evaluate(
        """async () => {
          const id = { 'X-Teleop-Client': sessionStorage.getItem('greenhouse-client') };
          const body = JSON.stringify({ source: 'greenhouse_demo', loop: true });
          const json = { ...id, 'Content-Type': 'application/json' };
          await fetch('/api/v1/sessions', { method: 'POST', headers: json, body });
          await fetch('/api/v1/lease/release', { method: 'POST', headers: id });
        }"""
    )
    wait_for("the bundled recording plays", lambda: server.plays("greenhouse_demo"))
