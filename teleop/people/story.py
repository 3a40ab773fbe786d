"""The demonstration: walk in, engage, drive, turn, pick, spray, disengage, leave; and what is true at each time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from teleop.people.motion import ArmKey, Key, Motion
from teleop.people.pose import unit
from teleop.people.rig import Floats

OPEN, RELAXED, FIST = 0.03, 0.3, 1.0
_UP, _FRONT = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, -1.0])


@dataclass(frozen=True, slots=True)
class Chapter:
    """From start_s on, until the next chapter: what the operator does, and whether they have engaged."""

    start_s: float
    name: str
    engaged: bool


def arm(
    sign: float,
    side_deg: float,
    front_deg: float = 0.0,
    elbow_deg: float = 170.0,
    bend: Floats = _UP,
    palm: Floats = _FRONT,
    curl: float = RELAXED,
) -> ArmKey:
    """Upper arm raised to the side and to the front (projected angles theta1, theta2), elbow angle theta3.

    sign: +1 right, -1 left. bend: the way the forearm folds. palm: the way the palm faces.
    """
    u = np.array([sign * np.tan(np.radians(side_deg)), -1.0, -np.tan(np.radians(front_deg))])
    u = unit(u)
    b = unit(bend - (bend @ u) * u)
    fold = np.radians(180.0 - elbow_deg)
    return ArmKey(u, np.cos(fold) * u + np.sin(fold) * b, palm, curl)


def hanging(sign: float, curl: float = RELAXED) -> ArmKey:
    """An arm at rest beside the body."""
    return arm(sign, 9.0, 2.0, 168.0, _FRONT, unit(np.array([-sign, 0.0, 0.35])), curl)


def beside_head(sign: float) -> ArmKey:
    """The engaging gesture: an open hand beside the head, elbow bent, palm to the sensor."""
    u = unit(np.array([sign * 0.85, -0.45, -0.12]))
    return ArmKey(u, unit(np.array([sign * 0.08, 1.0, -0.1])), _FRONT, OPEN)


class _Script:
    """Appends keys; what is not given stays as it was."""

    def __init__(self, x_m: float, z_m: float, turn_deg: float) -> None:
        self.keys = [Key(0.0, x_m, z_m, np.radians(turn_deg), hanging(1), hanging(-1), np.radians(3))]

    def to(
        self,
        seconds: float,
        *,
        at: tuple[float, float] | None = None,
        turn_deg: float | None = None,
        right: ArmKey | None = None,
        left: ArmKey | None = None,
        apart_deg: float | None = None,
    ) -> float:
        """Move within some seconds; returns the time of arrival."""
        k = self.keys[-1]
        x, z = at or (k.x_m, k.z_m)
        turn = k.turn_rad if turn_deg is None else float(np.radians(turn_deg))
        apart = k.apart_rad if apart_deg is None else float(np.radians(apart_deg))
        self.keys.append(Key(k.t_s + seconds, x, z, turn, right or k.right, left or k.left, apart))
        return self.keys[-1].t_s


def greenhouse_story(seed: int = 0) -> tuple[Motion, tuple[Chapter, ...]]:
    """About 42 s: the motion and its chapters."""
    s = _Script(1.75, 2.5, 75.0)
    chapters = [Chapter(0.0, "walk in", False)]
    s.to(0.5)
    s.to(2.2, at=(0.15, 2.4), turn_deg=55.0)
    s.to(0.7, at=(0.0, 2.35), turn_deg=0.0)
    t = s.to(0.3)
    chapters.append(Chapter(t, "engage", False))
    _gesture(s)
    t = s.to(0.3)
    chapters.append(Chapter(t, "drive forward", True))
    s.to(1.2, at=(0.0, 1.68))
    t = s.to(1.6)
    chapters.append(Chapter(t, "drive back", True))
    s.to(2.0, at=(0.0, 3.12))
    t = s.to(1.4)
    chapters.append(Chapter(t, "turn", True))
    s.to(1.6, at=(0.6, 2.4))
    s.to(1.6)
    s.to(1.3, at=(0.0, 2.35))
    t = s.to(0.8, apart_deg=24.0)
    chapters.append(Chapter(t, "pick", True))
    _pick(s)
    t = s.to(0.8, right=hanging(1), left=hanging(-1), apart_deg=3.0)
    chapters.append(Chapter(t, "spray", True))
    _spray(s)
    t = s.to(0.6, right=hanging(1), left=hanging(-1))
    chapters.append(Chapter(t, "disengage", True))
    _gesture(s)
    t = s.to(0.2)
    chapters.append(Chapter(t, "leave", False))
    s.to(1.1, at=(0.0, 3.0))
    s.to(0.6, at=(-0.2, 3.0), turn_deg=70.0)
    s.to(2.4, at=(-2.3, 2.9), turn_deg=80.0)
    s.to(0.4)
    return Motion(s.keys, seed), tuple(chapters)


def _gesture(s: _Script) -> None:
    s.to(0.9, right=beside_head(1), left=beside_head(-1))
    s.to(1.6)
    s.to(0.9, right=hanging(1, OPEN), left=hanging(-1, OPEN))


def _pick(s: _Script) -> None:
    """The right arm through bins of 15 degrees; grip; cut with the left fist; lower; let go."""
    left = arm(-1, 30, 5, 95, palm=_FRONT, curl=OPEN)
    s.to(0.7, right=arm(1, 15, 3, 150, palm=_FRONT, curl=OPEN), left=left)
    s.to(0.6, right=arm(1, 30, 3, 140, curl=OPEN))
    s.to(0.6, right=arm(1, 45, 5, 130, curl=OPEN))
    s.to(0.7, right=arm(1, 60, 5, 115, curl=OPEN))
    s.to(0.5)
    s.to(0.5, right=arm(1, 60, 5, 115, curl=FIST))
    s.to(0.7)
    s.to(0.5, left=arm(-1, 30, 5, 95, curl=FIST))
    s.to(0.7)
    s.to(0.5, left=arm(-1, 30, 5, 95, curl=OPEN))
    s.to(0.9, right=arm(1, 30, 5, 100, curl=FIST))
    s.to(0.5)
    s.to(0.5, right=arm(1, 30, 5, 100, curl=OPEN))
    s.to(0.5)


def _spray(s: _Script) -> None:
    """Right fist to open: on; sweep; left fist to open: next liquid; right fist: off."""
    s.to(0.9, right=arm(1, 45, 5, 105, curl=FIST), left=arm(-1, 30, 5, 95, curl=FIST))
    s.to(0.8)
    s.to(0.5, right=arm(1, 45, 5, 105, curl=OPEN))
    s.to(0.9, right=arm(1, 75, 5, 120, curl=OPEN))
    s.to(0.9, right=arm(1, 30, 5, 105, curl=OPEN))
    s.to(0.5, left=arm(-1, 30, 5, 95, curl=OPEN))
    s.to(0.9, right=arm(1, 60, 5, 115, curl=OPEN))
    s.to(0.5, right=arm(1, 60, 5, 115, curl=FIST))
    s.to(0.8)
