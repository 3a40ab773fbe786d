"""Track every recording of a folder again, many at once, and say how well the person was seen in each.

python examples/retrack_folder.py recordings/ tracked/ --workers 2

What is done already is left, so it can be interrupted and run again; no server is needed.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from server.cli.track_archive import track_archive
from teleop.config import TeleopConfig
from teleop.parallel import open_pool
from teleop.software import library_digest


def confidence_of(rows: Path) -> tuple[int, float]:
    """Frames with a person, and the mean confidence of their joints, in one file of rows."""
    seen: list[float] = []
    with rows.open(encoding="utf-8") as file:
        for line in file:
            row = json.loads(line)
            if any(row["joints"].values()):
                values = row["confidence"].values()
                seen.append(sum(values) / len(values))
    return len(seen), sum(seen) / len(seen) if seen else 0.0


def main(arguments: list[str] | None = None) -> int:
    """Exit code 1 when a recording could not be tracked."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("output", type=Path)
    parser.add_argument("--workers", type=int, default=2)
    given = parser.parse_args(arguments)

    def told(finished: int, total: int, frames: int) -> None:
        print(f"{finished} of {total} recordings, {frames} frames", flush=True)

    with open_pool(given.workers, None, library_digest) as pool:
        summary = track_archive(given.folder, given.output, TeleopConfig(), pool, told)
    print(summary.line())
    for failure in summary.failed:
        print(f"failed: {failure}")
    for rows in sorted(given.output.rglob("*.jsonl")):
        frames, confidence = confidence_of(rows)
        print(f"{rows.relative_to(given.output)}: person in {frames} frames, mean confidence {confidence:.2f}")
    return 1 if summary.failed else 0


if __name__ == "__main__":
    raise SystemExit(main())
