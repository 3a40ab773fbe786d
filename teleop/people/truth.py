"""What is true in each frame of a performed story, as JSON rows that tests compare the tracker with."""

from __future__ import annotations

from typing import Any

import numpy as np

from teleop.frames import pixels
from teleop.intent_types import Hand, Mode, Zone
from teleop.joints import JOINT_INDEX, JOINT_NAMES
from teleop.people.performance import Take
from teleop.people.rig import Floats
from teleop.people.story import Chapter
from teleop.people.view import View

_DEPTH_CUTS_M = ((1.4, Zone.OUT), (1.9, Zone.FORWARD), (2.8, Zone.WORK), (3.4, Zone.BACK))
_CENTRE_M, _EDGE_M, _T1_DEG = 0.40, 0.90, 12.0
_OPEN_CURL, _FIST_CURL = 0.15, 0.85


def zone_of(spine_room_m: Floats) -> Zone:
    """The zone of a spine (3,) in levelled axes by the specification's defaults (section 3), without hysteresis."""
    x, z = abs(float(spine_room_m[0])), float(spine_room_m[2])
    if not _DEPTH_CUTS_M[0][0] <= z < _DEPTH_CUTS_M[-1][0] or x >= _EDGE_M:
        return Zone.OUT
    if x >= _CENTRE_M:
        return Zone.RIGHT if spine_room_m[0] > 0 else Zone.LEFT
    return next(zone for cut, zone in _DEPTH_CUTS_M[1:] if z < cut)


def t1_deg(joints_room_m: Floats) -> float:
    """Angle between the thighs in the x-y plane, degrees (source eq. 8-10), of levelled joints (20, 3)."""
    j = {name: joints_room_m[JOINT_INDEX[name], :2] for name in ("hip_right", "hip_left", "knee_right", "knee_left")}
    a, b = j["knee_right"] - j["hip_right"], j["knee_left"] - j["hip_left"]
    return float(np.degrees(np.arccos(np.clip(a @ b / np.sqrt((a @ a) * (b @ b)), -1.0, 1.0))))


def hand_of(curl: float) -> Hand:
    """Open, fist, or unknown between them."""
    return Hand.OPEN if curl < _OPEN_CURL else Hand.FIST if curl > _FIST_CURL else Hand.UNKNOWN


def _mode(seen: bool, engaged: bool | None, zone: Zone, picking: bool) -> Mode | None:
    if not seen:
        return Mode.NO_PERSON
    if engaged is None:
        return None
    if not engaged:
        return Mode.SEEN
    if zone is Zone.WORK:
        return Mode.PICKING if picking else Mode.SPRAYING
    return {Zone.FORWARD: Mode.FORWARD, Zone.BACK: Mode.BACK, Zone.LEFT: Mode.LEFT, Zone.RIGHT: Mode.RIGHT}.get(zone)


def truth_row(take: Take, chapters: tuple[Chapter, ...], view: View) -> dict[str, Any]:
    """One row: t, chapter, seen (head and spine in the image), engaged (null while the gesture is made), zone, mode
    (null where it is being decided), hands, T1 in degrees, joints in the camera's axes, metres."""
    t_s = take.frame.t_s
    chapter = [c for c in chapters if c.start_s <= t_s + 1e-9][-1]
    room = (take.joints_m - view.t_m) @ view.R
    k = take.frame.camera.depth
    uv = pixels(take.joints_m[[JOINT_INDEX["head"], JOINT_INDEX["spine"]]], take.frame.camera)
    seen = bool(((uv >= 0) & (uv < [k.width, k.height])).all())
    engaged = None if chapter.name.endswith("engage") else chapter.engaged
    zone, t1 = zone_of(room[JOINT_INDEX["spine"]]), t1_deg(room)
    right, left = (hand_of(c) for c in take.moment.curl)
    joints = {name: [round(float(v), 4) for v in take.joints_m[i]] for name, i in JOINT_INDEX.items()}
    return {
        "t": round(t_s, 6),
        "chapter": chapter.name,
        "seen": seen,
        "engaged": engaged,
        "zone": zone if seen else Zone.NONE,
        "mode": _mode(seen, engaged, zone, t1 > _T1_DEG),
        "hands": {"right": right, "left": left},
        "T1": round(t1, 2),
        "joints": {name: joints[name] for name in JOINT_NAMES} if seen else None,
    }
