"""The real ``teleop serve`` in its own process, playing the bundled recording, and what it says over HTTP."""

from __future__ import annotations

import os
import re
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import httpx

ROOT = Path(__file__).resolve().parents[2]
RECORDING = ROOT / "recordings" / "greenhouse_demo.mcap"
T = TypeVar("T")
START_S = 240.0
"""Compiling the kernels the first time takes a minute or two on a small machine."""


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def wait_for(what: str, ask: Callable[[], T | None], timeout_s: float = 40.0) -> T:
    """The first answer that is not None or False; fails with ``what`` when there is none in time."""
    end_s = time.monotonic() + timeout_s
    while time.monotonic() < end_s:
        answer = ask()
        if answer is not None and answer is not False:
            return answer
        time.sleep(0.05)
    raise AssertionError(f"not within {timeout_s:.0f} s: {what}")


class ConsoleServer:
    """Started and stopped by the tests; the port stays the same."""

    def __init__(self, folder: Path) -> None:
        self.port = free_port()
        self.url = f"http://127.0.0.1:{self.port}/"
        self._api = httpx.Client(base_url=f"{self.url}api/v1", timeout=10.0)
        self._folder = folder
        self._process: subprocess.Popen[bytes] | None = None
        self.studies = folder / "studies"
        """Folder of motions that ``motion.html`` plays."""

    def start(self) -> None:
        command = [sys.executable, "-c", "from server.cli import main; main()", "serve", "--loop"]
        command += ["--port", str(self.port), "--source", str(RECORDING)]
        with (self._folder / "serve.log").open("ab") as log:
            environment = {
                **os.environ,
                "TELEOP_LIBRARY": str(self._folder / "library"),
                "TELEOP_STUDIES": str(self.studies),
                "TELEOP_ACCESS__FILE": str(self._folder / "access.json"),
            }
            self._process = subprocess.Popen(command, cwd=ROOT, env=environment, stdout=log, stderr=log)
        wait_for("teleop serve answers", self._is_ready, START_S)

    def stop(self) -> int:
        """Ask the server to end; its exit code."""
        if self._process is None:
            return 0
        process, self._process = self._process, None
        process.terminate()
        try:
            return process.wait(20)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait(5)
            raise

    def state(self) -> dict[str, Any]:
        response = self._api.get("/state")
        response.raise_for_status()
        return dict(response.json())

    def plays(self, uri: str) -> bool:
        """Whether that is the source now; there is none for a moment while another one is opened."""
        return (self.state()["source"] or {}).get("uri") == uri

    def token(self, role: str) -> str:
        """The token of a role, which the server tells at its first start."""
        found = re.search(rf"\bgt_{role}_\S+", (self._folder / "serve.log").read_text())
        assert found is not None
        return found.group()

    def config(self) -> dict[str, Any]:
        response = self._api.get("/config")
        response.raise_for_status()
        return dict(response.json())

    def post(self, path: str, body: dict[str, Any] | None = None) -> httpx.Response:
        return self._api.post(path, json=body)

    def delete(self, path: str) -> httpx.Response:
        return self._api.delete(path)

    def _is_ready(self) -> bool:
        assert self._process is not None
        code = self._process.poll()
        log = self._folder / "serve.log"
        assert code is None, f"teleop serve ended with {code}: {log.read_text()[-2000:]}"
        try:
            return self._api.get("/state").status_code == 200
        except httpx.TransportError:
            return False
