"""``virtual:`` a rendered operator before a rendered sensor, acting the demonstration; no data set needed.

``virtual:[builtin|makehuman][,seed=N][,size=WxH][,fps=N][,rounds=N]``: the built-in body, or a MakeHuman one where its
files are; the demonstration once, or so many times.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from teleop.errors import SourceError
from teleop.frames import Camera, DepthFrame, kinect_v1
from teleop.people.builtin import builtin_body
from teleop.people.clothes import Wardrobe, dress
from teleop.people.makehuman import makehuman_body
from teleop.people.performance import Performance
from teleop.people.room import greenhouse_room
from teleop.people.shape import Shape
from teleop.people.story import greenhouse_story
from teleop.people.view import sensor_view
from teleop.sources.base import SourceInfo

_LEGAL = "virtual:[builtin|makehuman][,seed=N][,size=WxH][,fps=N][,rounds=N], such as virtual:makehuman,size=640x480"
SENSOR_HEIGHT_M, SENSOR_TILT_RAD = 1.20, -0.03
"""From here a person of middle height is seen from the crown to the knees at 1.7 m and whole beyond 2.6 m."""
WORK_CLOTHES = Wardrobe(
    top_m=0.008,
    sleeve_m=0.007,
    sleeve_length=1.9,
    hem_length=0.0,
    trousers_m=0.010,
    trousers_length=1.97,
    shoes_m=0.008,
    hair_m=0.014,
    hair_length=0.1,
    fold=0.35,
    cap=False,
    top_rgb=(46, 92, 128),
    trousers_rgb=(58, 62, 70),
    shoes_rgb=(70, 60, 52),
    hair_rgb=(52, 40, 32),
    skin_rgb=(206, 158, 130),
)


@dataclass(frozen=True, slots=True)
class VirtualOptions:
    """What the part after ``virtual:`` says."""

    makehuman: bool = False
    seed: int = 0
    width: int = 320
    height: int = 240
    fps: int = 30
    rounds: int = 1


def parse_options(arg: str) -> VirtualOptions:
    """Read the URI's argument. Raises SourceError naming the legal forms."""
    found: dict[str, int] = {}
    makehuman = False
    for word in filter(None, arg.split(",")):
        if word in ("builtin", "makehuman"):
            makehuman = word == "makehuman"
        elif match := re.fullmatch(r"(seed|fps|rounds)=(\d{1,6})", word):
            found[match[1]] = int(match[2])
        elif match := re.fullmatch(r"size=(\d{2,4})x(\d{2,4})", word):
            found |= {"width": int(match[1]), "height": int(match[2])}
        else:
            raise SourceError(f"virtual: does not know '{word}'; legal is {_LEGAL}")
    options = VirtualOptions(makehuman, **found)
    if not (1 <= options.fps <= 120 and 40 <= options.width <= 1920 and 30 <= options.height <= 1080):
        raise SourceError("virtual: fps must be 1..120 and the size 40x30..1920x1080")
    if not 1 <= options.rounds <= 1000:
        raise SourceError("virtual: rounds must be 1..1000")
    return options


class VirtualSource:
    """A rendered operator. Frames are the same in every run."""

    def __init__(self, options: VirtualOptions) -> None:
        """Raises DataError when MakeHuman's files are asked for and not there."""
        shape = Shape(height_m=1.74, mass_kg=72.0)
        body = makehuman_body(shape) if options.makehuman else builtin_body(shape)
        motion, _ = greenhouse_story(options.seed)
        self.performance = Performance(
            body,
            dress(body, WORK_CLOTHES, options.seed),
            motion,
            greenhouse_room(options.seed),
            sensor_view(SENSOR_HEIGHT_M, SENSOR_TILT_RAD),
            Camera(kinect_v1(options.width, options.height)),
            float(options.fps),
            seed=options.seed,
        )
        kind = "makehuman" if options.makehuman else "builtin"
        self._count = options.rounds * self.performance.frame_count
        rounds = f",rounds={options.rounds}" if options.rounds > 1 else ""
        self._info = SourceInfo(
            uri=f"virtual:{kind},seed={options.seed},size={options.width}x{options.height},fps={options.fps}{rounds}",
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
        first = int(np.ceil(max(0.0, from_s) * self.performance.frames_per_s - 1e-9))
        for number in range(first, self._count):
            if self._closed:
                return
            done, place = divmod(number, self.performance.frame_count)
            frame = self.performance.take(place).frame
            begin_ns = round(done * self.performance.frame_count / self.performance.frames_per_s * 1e9)
            yield replace(frame, t_ns=begin_ns + frame.t_ns, seq=number) if done else frame

    def close(self) -> None:
        """Frames end."""
        self._closed = True


def open_virtual(arg: str) -> VirtualSource:
    """Open ``virtual:`` with the text after the colon. Raises SourceError or DataError."""
    return VirtualSource(parse_options(arg))
