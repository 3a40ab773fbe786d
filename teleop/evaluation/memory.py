"""Largest resident memory of ``teleop track`` over a session."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from teleop.evaluation.section import Bench, Section, table

RECORDING = Path("recordings/greenhouse_demo.mcap")


def peak_memory_mb(command: list[str]) -> float:
    """Largest resident size of a program in MB (10^6 bytes). Raises CalledProcessError when it fails."""
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise subprocess.CalledProcessError(process.returncode, command)
    return float(usage.ru_maxrss * 1024 / 1e6)


def memory_section(bench: Bench) -> list[Section]:
    """``teleop track`` on the bundled recording (320x240 with colour) and on a rendered 640x480 session."""
    teleop = str(Path(sys.executable).with_name("teleop"))
    rows, figures = [], {}
    with tempfile.TemporaryDirectory() as folder, bench.counting("memory", 2) as advance:
        sources = ((str(RECORDING), "recording"), ("virtual:builtin,size=640x480,seconds=3", "rendered_640x480"))
        for source, key in sources:
            if key == "recording" and not RECORDING.is_file():
                advance()
                continue
            peak = peak_memory_mb([teleop, "track", source, "--output", f"{folder}/{key}.jsonl"])
            rows.append([f"`teleop track {source}`", f"{peak:.0f}"])
            figures[f"memory.{key}_mb"] = peak
            advance()
    return [Section("Memory", table(("command", "largest resident size MB"), rows), figures)]
