"""``virtual:live``: a rendered operator who is driven while they are seen, by sliders or a program."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator

from teleop.frames import DepthFrame
from teleop.people.puppet import Puppet
from teleop.people.wishes import Wish
from teleop.sources.base import SourceInfo
from teleop.sources.virtual_options import VirtualOptions

_LONGEST_STEP_S = 0.2
"""After a longer pause of the machine the operator goes on from where they are."""


class LivePuppetSource:
    """Frames at their own pace, as a sensor gives them; a frame that is late is left out, never sent late.

    ``wish`` may be set from any thread.
    """

    def __init__(
        self,
        options: VirtualOptions,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Raises DataError when MakeHuman's files are asked for and not there."""
        self.wish = Wish()
        self._stage = options.stage()
        self._puppet = Puppet(self.wish, options.seed)
        self._period_s = 1.0 / options.fps
        self._clock = clock
        self._closed = threading.Event()
        self._info = SourceInfo(uri=options.uri, kind="virtual", camera=self._stage.camera, live=True, has_color=True)

    @property
    def info(self) -> SourceInfo:
        """What is known of the source."""
        return self._info

    def frames(self, from_s: float = 0.0) -> Iterator[DepthFrame]:  # noqa: ARG002
        """Frames as time passes, until ``close``; stamped by the clock, from 0 on."""
        begin_s = last_s = self._clock()
        seq = 0
        while not self._closed.is_set():
            now_s = self._clock()
            moment = self._puppet.step(self.wish, min(now_s - last_s, _LONGEST_STEP_S) if seq else 0.0)
            last_s = now_s
            yield self._stage.take(moment, seq, round((now_s - begin_s) * 1e9)).frame
            seq += 1
            late_s = self._clock() - begin_s
            wait_s = self._period_s - late_s % self._period_s
            if self._closed.wait(wait_s):
                return

    def close(self) -> None:
        """Frames end; safe to call twice, from any thread."""
        self._closed.set()
