"""Largest resident memory of ``teleop track`` over a session."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from teleop.evaluation.motions import FreeMotion
from teleop.evaluation.section import Bench, Section, table
from teleop.recording.rgbd_writer import RgbdFolderWriter

RECORDING = Path("recordings/greenhouse_demo.mcap")
FRAMES = 45
_LAUNCH = """import resource, subprocess, sys
subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)"""
"""A small program in between: what forks counts the size of the one it came from."""


def peak_memory_mb(command: list[str]) -> float:
    """Largest resident size of a program in MB (10^6 bytes). Raises CalledProcessError when it fails."""
    done = subprocess.run([sys.executable, "-S", "-c", _LAUNCH, *command], stdout=subprocess.PIPE, check=True)
    return float(int(done.stdout) * 1024 / 1e6)


def write_session(folder: Path, bench: Bench) -> None:
    """A rendered session of 640x480 with colour as an RGB-D folder. Raises DataError without the people's data set."""
    writer: RgbdFolderWriter | None = None
    try:
        for case in bench.store.cases(FreeMotion(FRAMES, color=True), 1):
            if writer is None:
                writer = RgbdFolderWriter(folder, case.frame.camera)
            writer.write_frame(case.frame)
    finally:
        if writer is not None:
            writer.close()


def memory_section(bench: Bench) -> list[Section]:
    """``teleop track`` on the bundled recording (320x240 with colour) and on a rendered 640x480 session."""
    teleop = str(Path(sys.executable).with_name("teleop"))
    rows: list[list[str]] = []
    figures: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as scratch, bench.counting("memory", 2) as advance:
        session = Path(scratch) / "session"
        write_session(session, bench)
        sources = (
            (RECORDING, "recording", f"`teleop track {RECORDING}`, 320x240"),
            (session, "640x480", "`teleop track` of a rendered 640x480 session"),
        )
        for source, key, words in sources:
            if source.exists():
                peak = peak_memory_mb([teleop, "track", str(source), "--output", f"{scratch}/{key}.jsonl"])
                rows.append([words, f"{peak:.0f}"])
                figures[f"memory.{key}_mb"] = peak
            advance()
    return [Section("Memory", table(("command", "largest resident size MB"), rows), figures)]
