"""Exact replay: the bundled recording and a one-minute session of the rendered operator, each recorded with all that
happened and then verified twice, in two processes, by ``teleop replay --verify``.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from teleop.recording import McapSource

_FOLDER = Path("build/replay")
_SESSIONS = (
    ("bundled recording", ("recordings/greenhouse_demo.mcap",), "demo.mcap"),
    ("one minute of virtual:", ("virtual:rounds=2", "--seconds", "60"), "virtual.mcap"),
)
_TIMES = 2


def main() -> None:
    """Record, verify, print what each process said."""
    teleop = str(Path(sys.executable).with_name("teleop"))
    _FOLDER.mkdir(parents=True, exist_ok=True)
    bad = 0
    for name, (source, *options), file in _SESSIONS:
        path = _FOLDER / file
        subprocess.run([teleop, "record", source, str(path), "--engage", "--force", *options], check=True)
        recorded = McapSource(path)
        duration_s, count = recorded.info.duration_s, recorded.info.frame_count
        recorded.close()
        print(f"{name}: {count} frames in {duration_s:.1f} s, {path.stat().st_size / 1e6:.1f} MB", flush=True)
        for number in range(1, _TIMES + 1):
            verified = subprocess.run([teleop, "replay", str(path), "--verify"], capture_output=True, text=True)
            words = (verified.stdout or verified.stderr).strip().splitlines()
            print(
                f"  process {number}: {words[0] if words else 'said nothing'} (exit code {verified.returncode})",
                flush=True,
            )
            bad += verified.returncode != 0 or "bit for bit" not in verified.stdout
    if bad:
        raise SystemExit(f"bench: {bad} of {_TIMES * len(_SESSIONS)} replays differ")


if __name__ == "__main__":
    main()
