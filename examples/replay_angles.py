"""Replay a recorded session on a running server and write the operator's angles as CSV.

python examples/replay_angles.py greenhouse_demo angles.csv --seconds 10 --speed 2
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Iterator
from pathlib import Path

from server import wire
from server.client import TeleopClient, columns


def replayed(robot: TeleopClient, seconds: float) -> Iterator[wire.State]:
    """Each frame once, until the recording ends or ``seconds`` of it are over."""
    last_s = -1.0
    for state in robot.states():
        if state.source is None or state.source.ended:
            return
        if state.skeleton is not None and state.source.position_s > last_s:
            last_s = state.source.position_s
            yield state
        if state.source.position_s >= seconds:
            return


def main(arguments: list[str] | None = None) -> int:
    """Exit code 0."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("recording", help="name in the server's library")
    parser.add_argument("output", type=Path)
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--speed", type=float, default=1.0)
    parser.add_argument("--url", default="http://127.0.0.1:8000")
    given = parser.parse_args(arguments)
    with TeleopClient(given.url, name="angles") as robot:
        session = robot.open(given.recording)
        robot.speed(given.speed)
        table = columns(replayed(robot, given.seconds))
        robot.close_session(session.id)
        robot.release_lease()
    with given.output.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(table)
        writer.writerows(zip(*(column.tolist() for column in table.values()), strict=True))
    print(f"{len(table['t'])} frames -> {given.output}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
