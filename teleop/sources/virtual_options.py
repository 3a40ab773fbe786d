"""What stands behind ``virtual:``: the words of the URI, and the person, room and sensor they ask for."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path

from teleop.errors import SourceError
from teleop.frames import Camera, kinect_v1
from teleop.people.builtin import builtin_body
from teleop.people.clothes import Wardrobe, dress
from teleop.people.makehuman import makehuman_body
from teleop.people.performance import Stage
from teleop.people.room import greenhouse_room
from teleop.people.shape import Shape
from teleop.people.view import sensor_view

_LEGAL = (
    "virtual:[builtin|makehuman][,live|,script=FILE.toml][,seed=N][,size=WxH][,fps=N][,rounds=N], "
    "such as virtual:makehuman,size=640x480"
)
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
    """What the part after ``virtual:`` says. live: driven while it runs. script: a file that tells what to act."""

    makehuman: bool = False
    seed: int = 0
    width: int = 320
    height: int = 240
    fps: int = 30
    rounds: int = 1
    live: bool = False
    script: Path | None = None

    @property
    def uri(self) -> str:
        """In full, as recordings keep it."""
        words = ["makehuman" if self.makehuman else "builtin"]
        words += ["live"] if self.live else []
        words += [f"script={self.script}"] if self.script else []
        words += [f"seed={self.seed}", f"size={self.width}x{self.height}", f"fps={self.fps}"]
        words += [f"rounds={self.rounds}"] if self.rounds > 1 else []
        return f"virtual:{','.join(words)}"

    def stage(self) -> Stage:
        """The person in the greenhouse before the sensor. Raises DataError when MakeHuman's files are not there."""
        shape = Shape(height_m=1.74, mass_kg=72.0)
        body = makehuman_body(shape) if self.makehuman else builtin_body(shape)
        return Stage(
            body,
            dress(body, WORK_CLOTHES, self.seed),
            greenhouse_room(self.seed),
            sensor_view(SENSOR_HEIGHT_M, SENSOR_TILT_RAD),
            Camera(kinect_v1(self.width, self.height)),
            seed=self.seed,
        )


def parse_options(arg: str) -> VirtualOptions:
    """Read the URI's argument. Raises SourceError naming the legal forms."""
    options = VirtualOptions()
    for word in filter(None, arg.split(",")):
        if word in ("builtin", "makehuman"):
            options = replace(options, makehuman=word == "makehuman")
        elif word == "live":
            options = replace(options, live=True)
        elif match := re.fullmatch(r"script=(.+)", word):
            options = replace(options, script=Path(match[1]).expanduser())
        elif match := re.fullmatch(r"(seed|fps|rounds)=(\d{1,6})", word):
            number = int(match[2])
            if match[1] == "seed":
                options = replace(options, seed=number)
            elif match[1] == "fps":
                options = replace(options, fps=number)
            else:
                options = replace(options, rounds=number)
        elif match := re.fullmatch(r"size=(\d{2,4})x(\d{2,4})", word):
            options = replace(options, width=int(match[1]), height=int(match[2]))
        else:
            raise SourceError(f"virtual: does not know '{word}'; legal is {_LEGAL}")
    if not (1 <= options.fps <= 120 and 40 <= options.width <= 1920 and 30 <= options.height <= 1080):
        raise SourceError("virtual: fps must be 1..120 and the size 40x30..1920x1080")
    if not 1 <= options.rounds <= 1000:
        raise SourceError("virtual: rounds must be 1..1000")
    if options.live and (options.script or options.rounds > 1):
        raise SourceError("virtual: 'live' is driven while it runs and goes with neither 'script' nor 'rounds'")
    return options
