"""A sensor's frames, step by step, for ``teleop record``: read by a thread, watched, waited for when it is away."""

from __future__ import annotations

import time
from collections.abc import Callable, Generator

from server.engine.core import Core, Moment
from server.engine.mailbox import Mailbox
from server.engine.playback import Playback
from server.engine.reader import Reader
from server.engine.recording import SessionRecorder
from server.engine.ticks import Ticks
from server.settings import Settings
from teleop.errors import SourceError
from teleop.sources.base import Source

Tell = Callable[[str], None]


def live_moments(
    source: Source, core: Core, recorder: SessionRecorder, settings: Settings, seconds: float | None, tell: Tell
) -> Generator[Moment, None, None]:
    """Steps of the core, with frames and without, as in the server. Owns the source.

    tell: one line when the sensor stalls, and when it is back. Raises SourceError when it stays away longer than
    ``sensor.give_up_s``, or is gone for good.
    """
    mailbox = Mailbox()
    reader = Reader(source, Playback(False, None), mailbox, recorder)
    ticks = Ticks(settings.engine.tick_hz)
    begin_s = heard_s = time.monotonic()
    stalled = False
    reader.start()
    try:
        while seconds is None or time.monotonic() - begin_s < seconds:
            arrived = mailbox.take(ticks.due_s - time.monotonic())
            now_s = time.monotonic()
            if arrived is not None:
                if stalled:
                    tell("frames are coming again")
                heard_s, stalled = now_s, False
                moment = core.on_frame(arrived, True, 1.0)
                ticks.frame(arrived.received_s, time.monotonic())
                yield moment
                continue
            if now_s < ticks.due_s:
                continue
            fault = reader.fault
            silent_s = now_s - heard_s
            if not stalled and (fault is not None or silent_s > _STALL_S):
                stalled = True
                tell(f"{fault or f'no frames for {silent_s:.0f} s'}; waiting for it, Ctrl-C ends the recording")
            if stalled and (silent_s > settings.sensor.give_up_s or not reader.comes_back):
                raise SourceError(fault or f"no frames for {silent_s:.0f} s; check the sensor's cable")
            yield core.on_silence(fault is not None, 1.0)
            ticks.tick(time.monotonic())
    finally:
        reader.stop()


_STALL_S = 2.0
"""Silence after which it is told; the watchdog has stopped the robot long before."""
