"""``teleop doctor --source``: opens one source and tells how its frames come."""

from __future__ import annotations

import time
from typing import Final

from server.cli.check import Check, Status
from teleop.errors import TeleopError
from teleop.sources import open_source
from teleop.sources.statistics import FrameCounts, FrameStatistics

SECONDS: Final = 3.0
_LEAST_HZ: Final = 15.0
_LEAST_VALID: Final = 0.2
_MOST_LOST: Final = 0.02


def try_source(uri: str, seconds: float = SECONDS) -> Check:
    """Read frames for a while, as fast as they come; what was found and the next step."""
    statistics = FrameStatistics()
    try:
        source = open_source(uri)
        try:
            begin_s = time.monotonic()
            for frame in source.frames():
                now_s = time.monotonic()
                statistics.add(frame, now_s)
                if now_s - begin_s > seconds:
                    break
        finally:
            source.close()
    except TeleopError as error:
        return Check(uri, Status.MISSING, str(error), "see the line of this kind of sensor above")
    return judged(uri, statistics.finished(), source.info.live)


def judged(name: str, counts: FrameCounts, live: bool) -> Check:
    """What the figures of a source mean. live: its rate is the sensor's own."""
    if counts.frames == 0:
        return Check(name, Status.MISSING, "no frames", "choose another recording, or check the sensor's cable")
    colour = "with colour" if counts.color_frames else "no colour"
    found = (
        f"{counts.frames} frames at {counts.rate_hz:.1f}/s by their stamps, {counts.lost} missing, jitter "
        f"{counts.jitter_ms:.1f} ms, {100 * counts.valid:.0f} % of the pixels with a reading, {colour}"
    )
    if live and counts.lost > _MOST_LOST * (counts.frames + counts.lost):
        return Check(
            name, Status.MISSING, found, "frames get lost: plug the sensor into a port of its own, without a hub"
        )
    if counts.valid < _LEAST_VALID:
        step = "few readings: keep 0.8 to 4 m distance, keep sunlight and glass out of view, clean the sensor"
        return Check(name, Status.MISSING, found, step)
    if 0 < counts.rate_hz < _LEAST_HZ:
        return Check(name, Status.MISSING, found, "slow: 30 frames/s track best; use a USB 3 port or a smaller image")
    step = "" if counts.color_frames else "hands are read from depth alone; with colour they are read better"
    return Check(name, Status.OK, found, step)
