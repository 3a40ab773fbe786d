"""Runs the real ``teleop`` command in its own process."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np

from teleop.frames import Camera, DepthFrame, Intrinsics
from teleop.recording import McapWriter

COMMAND = (sys.executable, "-c", "from server.cli import main; main()")


def teleop(*arguments: str | Path, timeout_s: float = 60.0) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*COMMAND, *map(str, arguments)], capture_output=True, text=True, timeout=timeout_s, check=False
    )


def one_error_line(result: subprocess.CompletedProcess[str], code: int = 1) -> str:
    """The one line on standard error of a command that failed as it should."""
    assert result.returncode == code, result.stdout + result.stderr
    assert "Traceback" not in result.stderr
    lines = [line for line in result.stderr.splitlines() if line.startswith("teleop: ")]
    assert len(lines) == 1, result.stderr
    return lines[0]


def write_recording(path: Path, count: int = 30) -> Path:
    cam = Camera(Intrinsics(50.0, 50.0, 31.5, 23.5, 64, 48), mirrored=True)
    rng = np.random.default_rng(1)
    with McapWriter(path, cam, source_uri="made here") as writer:
        for i in range(count):
            depth = rng.integers(500, 4000, (48, 64), dtype=np.uint16)
            color = np.full((48, 64, 3), 90, np.uint8)
            writer.write_frame(DepthFrame(i * 33_333_333, depth, cam, color, i))
    return path
