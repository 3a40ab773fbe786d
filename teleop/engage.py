"""Gestures that engage, disengage and stop (specification, section 3), on levelled joints."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from teleop.angles import Vector
from teleop.config.intent import EngageConfig
from teleop.intent_types import SIDES, BodyAngles, Hand, Hands, Side
from teleop.skeleton import Skeleton


def hand_beside_head(skeleton: Skeleton, side: Side, elbow_deg: float | None, config: EngageConfig) -> bool:
    """One arm of the engage gesture: the hand beside the head on its own side, above its elbow, elbow bent."""
    head, hand, elbow = (skeleton.joint(n) for n in ("head", f"hand_{side}", f"elbow_{side}"))
    if head is None or hand is None or elbow is None or elbow_deg is None:
        return False
    out_m = (hand[0] - head[0]) * (1.0 if side == "right" else -1.0)
    up_m = hand[1] - head[1]
    return bool(
        config.beside_min_m <= out_m <= config.beside_max_m
        and -config.below_head_m <= up_m <= config.above_head_m
        and elbow[1] < hand[1]
        and elbow_deg < config.elbow_bent_deg
    )


def engage_pose(skeleton: Skeleton, angles: BodyAngles, hands: Hands, config: EngageConfig) -> bool:
    """Both hands beside the head, elbows bent, and both seen to be open: a hand that cannot be read engages nobody."""
    elbow_deg = {"right": angles.right.theta3_deg, "left": angles.left.theta3_deg}
    if not hands.right is hands.left is Hand.OPEN:
        return False
    return all(hand_beside_head(skeleton, side, elbow_deg[side], config) for side in SIDES)


PALM: Final = 1.3
"""The palm's middle, at this share of the forearm from the elbow (Winter 2009: hand 0.108, forearm 0.146 tall)."""


def _sides_of(a: Vector, b: Vector, p: Vector) -> float:
    return float((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]))


def segments_cross(a: Vector, b: Vector, c: Vector, d: Vector) -> bool:
    """Whether the segments a-b and c-d cross in the x-y plane."""
    return _sides_of(a, b, c) * _sides_of(a, b, d) < 0 and _sides_of(c, d, a) * _sides_of(c, d, b) < 0


def forearms_crossed(skeleton: Skeleton, config: EngageConfig) -> bool:
    """Forearms crossed before the chest: each wrist past the other, between hips and chin, the forearms crossing.

    An elbow under the other arm can be found decimetres off; wrists far past each other need no such proof, unless the
    shoulders have changed sides too: then the tracker took right for left.
    """
    names = ("wrist_right", "wrist_left", "elbow_right", "elbow_left", "shoulder_center", "hip_center")
    joints = [skeleton.joint(n) for n in names]
    wrist_r, wrist_l, elbow_r, elbow_l, neck, hip = joints
    if wrist_r is None or wrist_l is None or elbow_r is None or elbow_l is None or neck is None or hip is None:
        return False
    passed_m = wrist_l[0] - wrist_r[0]
    low, high = hip[1] + 0.25 * (neck[1] - hip[1]), neck[1] + 0.10
    at_chest = all(low <= wrist[1] <= high for wrist in (wrist_r, wrist_l))
    # a forearm reaches to the palm: arms that cross at their wrists are crossed whatever a centimetre of noise says
    palm_r, palm_l = (elbow + PALM * (wrist - elbow) for elbow, wrist in ((elbow_r, wrist_r), (elbow_l, wrist_l)))
    shoulder_r, shoulder_l = skeleton.joint("shoulder_right"), skeleton.joint("shoulder_left")
    exchanged = shoulder_r is not None and shoulder_l is not None and shoulder_r[0] < shoulder_l[0]
    far = passed_m >= config.crossed_far_m and not exchanged
    crossing = far or segments_cross(elbow_r, palm_r, elbow_l, palm_l)
    return bool(passed_m >= config.crossed_m and at_chest and crossing)


@dataclass(frozen=True, slots=True)
class GestureState:
    """Progress of both gestures in seconds. armed: the engage pose was let go since it last counted."""

    engage_s: float = 0.0
    released_s: float = 0.0
    armed: bool = True
    crossed_s: float = 0.0


@dataclass(frozen=True, slots=True)
class Gestures:
    """What the gestures say at this frame. toggle is true once per gesture; stop as long as the forearms cross."""

    toggle: bool
    stop: bool
    progress: float


def step_gestures(
    state: GestureState, engage: bool, crossed: bool, dt_s: float, config: EngageConfig
) -> tuple[Gestures, GestureState]:
    """One frame: whether the two poses are held now, in; whether the gestures are complete, out."""
    released_s = 0.0 if engage else state.released_s + dt_s
    armed = state.armed or released_s >= config.release_s
    grown = state.engage_s + dt_s if engage and armed else state.engage_s - config.leak * dt_s
    engage_s = min(config.hold_s, max(0.0, grown))
    toggle = armed and engage and engage_s >= config.hold_s - 1e-9
    crossed_s = state.crossed_s + dt_s if crossed else state.crossed_s - config.leak * dt_s
    crossed_s = min(config.crossed_s, max(0.0, crossed_s))
    stop = crossed_s >= config.crossed_s - 1e-9
    after = GestureState(0.0 if toggle else engage_s, released_s, armed and not toggle, crossed_s)
    return Gestures(toggle, stop, 1.0 if toggle else engage_s / config.hold_s), after
