"""From the operator's arm to servo set-points of a robot arm (source eq. 14-21, specification, section 4).

``paper``: C2 from theta1, C1 from theta2, in steps of 15 degrees. ``direction``: C1 and C2 solved together so that
the robot's upper arm points as the operator's does. Both: whole degrees; the elbow is continuous, 90..180.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from robot_sim.arm_angles import shoulder_from_direction
from robot_sim.commands import ArmTarget
from teleop.angles import Vector, angle_deg
from teleop.borders import Border, accumulate
from teleop.config.intent import AngleConfig, MappingConfig
from teleop.intent_types import Side
from teleop.joints import JOINT_INDEX
from teleop.reasons import Reason
from teleop.skeleton import Skeleton


@dataclass(frozen=True, slots=True)
class Measured:
    """What one operator arm asks of the robot, continuous, in degrees; None where there is no answer.

    weight: squared projection length as a part of the bone's, 0..1: how well the projected angle is known.
    """

    c1_deg: float | None = None
    c2_deg: float | None = None
    elbow_deg: float | None = None
    c1_weight: float = 1.0
    c2_weight: float = 1.0
    reasons: tuple[Reason, ...] = ()


def bone_forward_outward_up(bone: Vector, side: Side) -> tuple[float, float, float]:
    """A bone in levelled skeleton axes as (forward, outward, up) of an operator who faces the sensor."""
    return -float(bone[2]), float(bone[0]) * (1.0 if side == "right" else -1.0), float(bone[1])


def signed_deg(positive: float, up: float) -> float:
    """Angle from hanging down towards ``positive``, -90..270 degrees, continuous across the top.

    Unsigned, as eq. (17), (18) have it (arc cosine, ``teleop.angles``, shown and recorded): an arm swung 20 degrees
    back and one 20 degrees forward give the same 20. Signed, as here (atan2, sent to the robot): -20 and 20; the two
    agree on the source's whole range 0..90, and a negative angle is clamped to 0 with limit.shoulder_range instead of
    sending the robot's arm to the wrong side.
    """
    angle = math.degrees(math.atan2(positive, -up))
    return angle if angle >= -90.0 else angle + 360.0


def measure(skeleton: Skeleton, side: Side, mapping: MappingConfig, angles: AngleConfig) -> Measured:
    """The shoulder and elbow angles one operator arm asks for, gated by confidence and projection length."""
    shoulder, elbow, wrist = (skeleton.joint(f"{name}_{side}") for name in ("shoulder", "elbow", "wrist"))
    confidence = [skeleton.confidence[JOINT_INDEX[f"{name}_{side}"]] for name in ("shoulder", "elbow", "wrist")]
    if shoulder is None or elbow is None:
        return Measured(reasons=(Reason.ARM_UNKNOWN,))
    if min(confidence[:2]) < mapping.min_confidence:
        return Measured(reasons=(Reason.LOW_CONFIDENCE,))
    bone = elbow - shoulder
    length = float(np.linalg.norm(bone))
    if length < angles.min_bone_m:
        return Measured(reasons=(Reason.ARM_UNKNOWN,))
    reasons: list[Reason] = []
    elbow_deg = None
    if wrist is None:
        reasons.append(Reason.ARM_UNKNOWN)
    elif confidence[2] < mapping.min_confidence:
        reasons.append(Reason.LOW_CONFIDENCE)
    elif float(np.linalg.norm(wrist - elbow)) >= angles.min_bone_m:
        elbow_deg = angle_deg(-bone, wrist - elbow)  # (19)-(21)
    forward, outward, up = (part / length for part in bone_forward_outward_up(bone, side))
    c1_weight, c2_weight = forward**2 + up**2, outward**2 + up**2
    c1: float | None
    c2: float | None
    if mapping.mapping == "paper":
        c1, c2 = signed_deg(forward, up), signed_deg(outward, up)  # (18), (17)
        if c2_weight < angles.min_projection**2:
            c2 = None
            reasons.append(Reason.SHORT_PROJECTION)
    else:
        c1, c2 = shoulder_from_direction(forward, outward, up)
        c2_weight = 1.0
    if c1_weight < angles.min_projection**2:
        c1 = None
        reasons.append(Reason.SHORT_PROJECTION)
    return Measured(c1, c2, elbow_deg, c1_weight, c2_weight, tuple(reasons))


@dataclass(frozen=True, slots=True)
class Axis:
    """One shoulder set-point with the evidence for leaving it upwards and downwards."""

    sent_deg: float = 0.0
    up: float = 0.0
    down: float = 0.0
    since_step_s: float = math.inf


def nearest_step(angle_deg: float, config: MappingConfig) -> float:
    """The source's discretisation: 0-7.5 -> 0, 7.5-22.5 -> 15, ... limited to 0..shoulder_max_deg."""
    largest = math.floor(config.shoulder_max_deg / config.step_deg)
    return config.step_deg * min(largest, max(0, math.floor(angle_deg / config.step_deg + 0.5)))


def step_axis(
    axis: Axis, angle_deg: float | None, weight: float, dt_s: float, easing: bool, config: MappingConfig
) -> Axis:
    """One frame of a stepped axis: the set-point leaves its bin only on evidence, in easing one step at a time.

    An arm that stood between two steps first goes to the nearer one.
    """
    since = axis.since_step_s + dt_s
    if angle_deg is None:
        return Axis(axis.sent_deg, 0.0, 0.0, since)
    step_deg = nearest_step(axis.sent_deg, config)
    if easing and axis.sent_deg != step_deg:
        return Axis(_towards(axis.sent_deg, step_deg, _ease_deg(dt_s, config)), 0.0, 0.0, since)
    angle = min(config.shoulder_max_deg, max(0.0, angle_deg))
    half = config.step_deg / 2
    border = Border(config.margin_deg, config.evidence_deg_s, config.clip_deg)
    up = accumulate(axis.up, angle - (axis.sent_deg + half), dt_s, border, weight)
    down = accumulate(axis.down, (axis.sent_deg - half) - angle, dt_s, border, weight)
    if up <= border.evidence and down <= border.evidence:
        return Axis(axis.sent_deg, up, down, since)
    sign = 1.0 if up > border.evidence else -1.0
    if easing and since < config.ease_step_s:
        return Axis(axis.sent_deg, up, down, since)
    neighbour = step_deg + sign * config.step_deg
    target = (
        neighbour if easing else sign * max(sign * neighbour, sign * nearest_step(angle - sign * border.margin, config))
    )
    return Axis(nearest_step(target, config), 0.0, 0.0, 0.0)


def glide_axis(axis: Axis, angle_deg: float | None, dt_s: float, easing: bool, config: MappingConfig) -> Axis:
    """One frame of a continuous axis with a dead band; in easing its speed is limited."""
    if angle_deg is None:
        return axis
    angle = min(config.shoulder_max_deg, max(0.0, angle_deg))
    change = angle - axis.sent_deg
    if abs(change) <= config.direction_deadband_deg:
        return axis
    return Axis(_towards(axis.sent_deg, angle, _ease_deg(dt_s, config)) if easing else angle)


def _ease_deg(dt_s: float, config: MappingConfig) -> float:
    """How far a shoulder may go in one frame of easing in."""
    return config.step_deg / config.ease_step_s * dt_s if config.ease_step_s > 0 else math.inf


def _towards(now: float, goal: float, most: float) -> float:
    return goal if abs(goal - now) <= most else now + math.copysign(most, goal - now)


@dataclass(frozen=True, slots=True)
class ArmMemory:
    """What was sent to one robot arm last, and whether the arm still eases towards the operator's."""

    c1: Axis = Axis()
    c2: Axis = Axis()
    elbow_deg: float = 180.0
    easing: bool = True

    @property
    def target(self) -> ArmTarget:
        """Set-points in whole degrees, as the source sends them."""
        return ArmTarget(float(round(self.c1.sent_deg)), float(round(self.c2.sent_deg)), float(round(self.elbow_deg)))


def eased_from(target: ArmTarget) -> ArmMemory:
    """Memory of an arm that stands somewhere and starts to ease in from there."""
    return ArmMemory(Axis(_whole(target.c1_deg)), Axis(_whole(target.c2_deg)), target.elbow_deg)


def _whole(angle_deg: float) -> float:
    """The angle without what rounding to radians and back did to it."""
    return float(round(angle_deg)) if abs(angle_deg - round(angle_deg)) < 1e-6 else angle_deg


def _arrived(memory: ArmMemory, wanted: Measured, elbow_deg: float, config: MappingConfig) -> bool:
    near = config.step_deg / 2 + config.margin_deg
    for axis, angle in ((memory.c1, wanted.c1_deg), (memory.c2, wanted.c2_deg)):
        if config.mapping == "paper" and axis.sent_deg != nearest_step(axis.sent_deg, config):
            return False
        if angle is not None and abs(min(config.shoulder_max_deg, max(0.0, angle)) - axis.sent_deg) > near:
            return False
    return abs(memory.elbow_deg - elbow_deg) < 1.0


def step_arm(
    memory: ArmMemory, wanted: Measured, dt_s: float, config: MappingConfig
) -> tuple[ArmMemory, tuple[Reason, ...]]:
    """One frame of one robot arm: the new set-points, and why they are not what was asked for."""
    reasons = list(wanted.reasons)
    shoulder = [angle for angle in (wanted.c1_deg, wanted.c2_deg) if angle is not None]
    if any(angle > config.shoulder_max_deg + 0.5 or angle < -0.5 for angle in shoulder):
        reasons.append(Reason.SHOULDER_RANGE)
    elbow_deg = memory.elbow_deg
    if wanted.elbow_deg is not None:
        elbow_deg = min(180.0, max(config.elbow_min_deg, wanted.elbow_deg))
        if wanted.elbow_deg < config.elbow_min_deg - 0.5:
            reasons.append(Reason.ELBOW_RANGE)
    if config.mapping == "paper":
        c1 = step_axis(memory.c1, wanted.c1_deg, wanted.c1_weight, dt_s, memory.easing, config)
        c2 = step_axis(memory.c2, wanted.c2_deg, wanted.c2_weight, dt_s, memory.easing, config)
    else:
        c1 = glide_axis(memory.c1, wanted.c1_deg, dt_s, memory.easing, config)
        c2 = glide_axis(memory.c2, wanted.c2_deg, dt_s, memory.easing, config)
    change = elbow_deg - memory.elbow_deg
    if memory.easing:
        reasons.append(Reason.EASE_IN)
        limit = config.ease_elbow_deg_s * dt_s
        change = min(limit, max(-limit, change))
    after = ArmMemory(c1, c2, memory.elbow_deg + change, memory.easing)
    if memory.easing and dt_s > 0 and not wanted.reasons and _arrived(after, wanted, elbow_deg, config):
        after = ArmMemory(c1, c2, after.elbow_deg, easing=False)
    return after, tuple(dict.fromkeys(reasons))
