"""A virtual operator who acts a script, or is driven while they are seen."""

from __future__ import annotations

from itertools import islice, pairwise
from pathlib import Path

import pytest

from teleop.errors import SourceError
from teleop.people.wishes import Wish
from teleop.sources import open_source
from teleop.sources.virtual_live import LivePuppetSource
from teleop.sources.virtual_options import parse_options

SMALL = "size=80x60,fps=10"
SCRIPT = """
[[step]]
seconds = 0.5
[[step]]
seconds = 1.5
x_m = 0.5
right = { side_deg = 60, hand = "open" }
"""


def script(folder: Path, text: str = SCRIPT) -> Path:
    path = folder / "acts.toml"
    path.write_text(text)
    return path


def test_a_script_is_acted_and_can_be_sought(tmp_path: Path) -> None:
    source = open_source(f"virtual:script={script(tmp_path)},{SMALL}")
    frames = list(source.frames())
    assert source.info.duration_s == pytest.approx(2.0)
    assert [f.seq for f in frames] == list(range(21))
    assert (frames[2].depth_mm != frames[-1].depth_mm).any()
    later = next(iter(source.frames(1.5)))
    assert later.seq == 15
    assert (later.depth_mm == frames[15].depth_mm).all()
    assert str(tmp_path) in source.info.uri


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("seconds = 1", "step"),
        ("[[step]]\nseconds = 0", "step.0.seconds"),
        ("[[step]]\nseconds = 1\nz_m = 99", "step.0.z_m"),
        ("[[step]]\nseconds = 1\nright = { hand = 'claw' }", "step.0.right.hand"),
        ("[[step]]\nseconds = 1\nwings = 2", "wings"),
        ("[[step", "no TOML"),
        ("[[step]]\nseconds = 600\n" * 7, "3600"),
    ],
)
def test_a_wrong_script_is_told(tmp_path: Path, text: str, words: str) -> None:
    with pytest.raises(SourceError, match=words):
        open_source(f"virtual:script={script(tmp_path, text)}")


def test_a_script_that_is_not_there_is_told(tmp_path: Path) -> None:
    with pytest.raises(SourceError, match=r"cannot read the script .*nowhere"):
        open_source(f"virtual:script={tmp_path / 'nowhere.toml'}")


@pytest.mark.parametrize("argument", ["live,rounds=2", "live,script=a.toml"])
def test_a_driven_operator_has_no_script(argument: str) -> None:
    with pytest.raises(SourceError, match="live"):
        open_source(f"virtual:{argument}")


class Clock:
    """Each look at it takes a tenth of a second."""

    def __init__(self) -> None:
        self.now_s = 100.0

    def __call__(self) -> float:
        self.now_s += 0.1
        return self.now_s


def test_a_driven_operator_follows_and_their_stamps_are_the_clock_s() -> None:
    source = LivePuppetSource(parse_options(f"live,{SMALL}"), Clock())
    frames = source.frames()
    still = list(islice(frames, 3))
    source.wish = Wish(x_m=0.8, z_m=1.8)
    moved = list(islice(frames, 12))[-1]
    source.close()
    assert source.info.live
    assert all(b.t_ns > a.t_ns for a, b in pairwise(still))
    near = [int((f.depth_mm[f.depth_mm > 0] < 2100).sum()) for f in (still[0], moved)]
    assert near[1] > near[0] + 50, "they have come nearer"
    assert list(frames) == []
