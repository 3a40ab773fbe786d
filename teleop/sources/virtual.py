"""``virtual:`` a rendered operator before a rendered sensor; no camera and no data set needed.

``virtual:[builtin|makehuman][,live|,script=FILE.toml][,seed=N][,size=WxH][,fps=N][,rounds=N]``: the built-in body, or
a MakeHuman one where its files are. They act the demonstration, or what a file tells (``script=``), once or so many
times (``rounds=``); ``live`` is driven while it runs, by the console's sliders or over the API.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Protocol

import numpy as np

from teleop.frames import Camera, DepthFrame
from teleop.people.performance import Performance, Take
from teleop.people.story import greenhouse_story
from teleop.sources.base import Source, SourceInfo
from teleop.sources.virtual_live import LivePuppetSource
from teleop.sources.virtual_options import VirtualOptions, parse_options
from teleop.sources.virtual_script import ScriptedPerformance, read_script


class Acted(Protocol):
    """What is acted, frame by frame."""

    @property
    def frames_per_s(self) -> float:
        """The rate."""
        ...

    @property
    def camera(self) -> Camera:
        """The sensor's."""
        ...

    @property
    def frame_count(self) -> int:
        """Frames of one round."""
        ...

    def take(self, number: int) -> Take:
        """One frame; deterministic."""
        ...


class VirtualSource:
    """A rendered operator acting. Frames are the same in every run."""

    def __init__(self, options: VirtualOptions) -> None:
        """Raises DataError when MakeHuman's files are asked for and not there, SourceError for a wrong script."""
        self.performance = _performance(options)
        self._count = options.rounds * self.performance.frame_count
        self._info = SourceInfo(
            uri=options.uri,
            kind="virtual",
            camera=self.performance.camera,
            live=False,
            frame_count=self._count,
            duration_s=(self._count - 1) / options.fps,
            has_color=True,
        )
        self._closed = False

    @property
    def info(self) -> SourceInfo:
        """What is known of the source."""
        return self._info

    def frames(self, from_s: float = 0.0) -> Iterator[DepthFrame]:
        """Frames in order from ``from_s`` seconds on, rendered as they are asked for."""
        acted = self.performance
        first = int(np.ceil(max(0.0, from_s) * acted.frames_per_s - 1e-9))
        for number in range(first, self._count):
            if self._closed:
                return
            done, place = divmod(number, acted.frame_count)
            frame = acted.take(place).frame
            begin_ns = round(done * acted.frame_count / acted.frames_per_s * 1e9)
            yield replace(frame, t_ns=begin_ns + frame.t_ns, seq=number) if done else frame

    def close(self) -> None:
        """Frames end."""
        self._closed = True


def _performance(options: VirtualOptions) -> Acted:
    stage = options.stage()
    if options.script is not None:
        return ScriptedPerformance(stage, read_script(options.script), float(options.fps))
    motion, _ = greenhouse_story(options.seed)
    return Performance(stage, motion, float(options.fps))


def open_virtual(arg: str) -> Source:
    """Open ``virtual:`` with the text after the colon. Raises SourceError or DataError."""
    options = parse_options(arg)
    return LivePuppetSource(options) if options.live else VirtualSource(options)
