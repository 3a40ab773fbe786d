"""``teleop serve`` as a process: starts, plays, stops cleanly; every wrong start is one line."""

from __future__ import annotations

import json
import os
import shutil
import signal
import socket
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from cli_process import COMMAND, one_error_line, teleop
from live_server import write_walk

from server.client import TeleopClient
from teleop.sources import open_source

START_S = 240.0
"""Compiling the kernels the first time takes a minute or two on a small machine."""


@pytest.fixture
def port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@pytest.fixture
def served(
    tmp_path: Path, port: int, request: pytest.FixtureRequest
) -> Iterator[tuple[subprocess.Popen[str], str, Path]]:
    """Plain, or over TLS with a certificate of its own when the test's ``scheme`` is https."""
    scheme = request.getfixturevalue("scheme")
    recording = write_walk(tmp_path / "walk.mcap")
    library = tmp_path / "library"
    arguments = ["serve", "--port", str(port), "--source", str(recording), "--loop", "--record"]
    arguments += ["--log-format", "json"]
    if scheme == "https":
        arguments += certificate(tmp_path)
    process = subprocess.Popen(
        [*COMMAND, *arguments],
        env={**os.environ, "TELEOP_LIBRARY": str(library), "TELEOP_ACCESS__FILE": str(tmp_path / "access.json")},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        url = f"{scheme}://127.0.0.1:{port}"
        end_s = time.monotonic() + START_S
        while time.monotonic() < end_s and process.poll() is None:
            try:
                if httpx.get(f"{url}/api/v1/state", verify=False).is_success:
                    break
            except httpx.TransportError:
                time.sleep(0.1)
        yield process, url, library
    finally:
        process.kill()
        process.wait(10)


@pytest.mark.parametrize(("scheme", "number"), [("http", signal.SIGINT), ("https", signal.SIGTERM)])
def test_it_plays_until_told_to_stop_and_completes_the_recording(
    served: tuple[subprocess.Popen[str], str, Path], scheme: str, number: signal.Signals
) -> None:
    process, url, library = served
    assert url.startswith(scheme)
    with TeleopClient(url, verify=False) as robot:
        states = robot.states()
        first = next(states)
        assert first.source is not None and first.source.uri == "walk"
        assert next(s for s in states if s.skeleton is not None).latency_ms["tracking"].p50 > 0
        robot.estop()
        assert next(s for s in states if s.robot.estop).command.drive_m_s == 0.0
        robot.estop_reset()
        assert robot.pause().paused and not robot.play().paused
        assert "<robot" in robot.urdf()
        assert robot.sessions()[0].recording is not None
    process.send_signal(signal.SIGHUP)
    time.sleep(0.2)
    process.send_signal(number)
    out, err = process.communicate(timeout=20)
    assert process.returncode == 0, err
    assert out.splitlines()[0].startswith(url) and out.splitlines()[-1] == "stopped"
    assert "Traceback" not in err and "pybullet" not in out + err
    told = [line.split() for line in out.splitlines() if line.startswith("  ")]
    assert [role for role, _ in told] == ["viewer", "operator", "supervisor"], "the tokens, shown once"
    log = [json.loads(line) for line in err.splitlines()]
    assert {"serving", "estop", "settings reloaded", "stopped"} <= {row.get("action") or row["message"] for row in log}
    assert not any(token in err for _, token in told)
    (made,) = library.glob("*.mcap")
    source = open_source(str(made))
    assert source.info.frame_count and getattr(source, "truncated", None) is None
    events = [row for _, row in source.rows("/teleop/events")]  # type: ignore[attr-defined]
    assert [row["reason"] for row in events if row["kind"] != "audit"][-3:].count("stop.estop"), (
        "the end stops the robot"
    )
    source.close()


def certificate(folder: Path) -> list[str]:
    """A self-signed certificate for this test; none is kept in the repository."""
    if shutil.which("openssl") is None:
        pytest.skip("openssl is not installed, so there is no certificate to serve with")
    pair = ["--tls-cert", str(folder / "cert.pem"), "--tls-key", str(folder / "key.pem")]
    command = ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "1", "-subj", "/CN=127.0.0.1"]
    subprocess.run([*command, "-out", pair[1], "-keyout", pair[3]], check=True, capture_output=True)
    return pair


def test_a_busy_port_is_one_line(port: int) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", port))
        taken.listen()
        line = one_error_line(teleop("serve", "--port", str(port)))
    assert f"port {port} is in use" in line and "--port" in line


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--source", "nothing.mcap"), "nothing.mcap"),
        (("--source", "rubbish:"), "legal are"),
        (("--port", "99999"), "1 <= value <= 65535"),
        (("--host", "no.such.host.invalid"), "no address of this computer"),
        (("--config", "nothing.toml"), "nothing.toml"),
        (("--tls-cert", "nothing.pem"), "belong together"),
        (("--log-format", "xml"), "log_format"),
    ],
)
def test_a_wrong_start_is_one_line(arguments: tuple[str, str], words: str, port: int) -> None:
    given = arguments if "--port" in arguments else (*arguments, "--port", str(port))
    assert words in one_error_line(teleop("serve", *given))


def test_a_client_without_a_server_says_so(port: int) -> None:
    from server.errors import ServerError

    with TeleopClient(f"http://127.0.0.1:{port}") as robot, pytest.raises(ServerError, match="teleop serve"):
        robot.state()
