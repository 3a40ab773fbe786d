"""Poses made by rule: no data set needed. Random arms over the full reach, task poses, standing and striding legs."""

from __future__ import annotations

import numpy as np

from teleop.people.pose import ArmPose, LegPose, Pose, rotation, unit, yaw
from teleop.people.rig import Floats

_UP = np.array([0.0, 1.0, 0.0])


def mirrored(v: Floats) -> Floats:
    """A direction on the other side of the body."""
    return v * np.array([-1.0, 1.0, 1.0])


def _arm(rng: np.random.Generator, upper: Floats, fore: Floats, pronation: float, spread: float) -> ArmPose:
    """An arm with a random turn of the forearm and an open, relaxed or closed hand."""
    curl = float(rng.choice([rng.uniform(0, 0.12), rng.uniform(0.15, 0.45), rng.uniform(0.85, 1.0)]))
    turned = float(np.clip(rng.normal(pronation, spread), -1.5, 1.6))
    return ArmPose(upper, fore, pronation_rad=turned, curl=curl, spread_rad=float(rng.uniform(0, 0.16)))


def hanging_arm(rng: np.random.Generator, sign: float) -> ArmPose:
    """An arm hanging down, slightly bent."""
    u = unit(np.array([sign * rng.uniform(0.02, 0.35), -1.0, rng.normal(0, 0.12)]))
    f = unit(u + np.array([sign * rng.uniform(-0.18, 0.02), 0.0, -rng.uniform(0.0, 0.35)]))
    return _arm(rng, u, f, 0.3, 0.4)


def random_arm(rng: np.random.Generator, sign: float) -> ArmPose:
    """An arm anywhere within a shoulder's reach, the elbow bent 0..150 degrees."""
    while True:
        u = unit(rng.normal(0, 1, 3))
        out, back = sign * u[0], u[2]
        if back < 0.45 and out > -0.6 and not (out < -0.25 and back > -0.3):
            break
    bend = float(rng.uniform(0, 2.6) * rng.uniform(0.0, 1.0) ** 0.4)
    for _ in range(40):
        side = unit(np.cross(u, rng.normal(0, 1, 3)))
        f = np.cos(bend) * u + np.sin(bend) * side
        # The elbow folds towards the front, the middle or upwards, never outwards to the back.
        if side[2] < 0.35 and sign * side[0] < 0.75 and f[2] < 0.6:
            break
    return _arm(rng, u, f, 0.4, 0.7)


def plane_arm(rng: np.random.Generator, sign: float) -> ArmPose:
    """An arm raised in the frontal or sagittal plane by 0..100 degrees (the source's experiment)."""
    raised, bend = np.radians(rng.uniform(0, 100)), np.radians(rng.uniform(0, 100)) * rng.integers(0, 2)
    turn = rng.choice([0.0, np.pi / 2, rng.uniform(0, np.pi / 2)])
    away = np.array([sign * np.cos(turn), 0.0, -np.sin(turn)])
    u = unit(np.sin(raised) * away - np.cos(raised) * _UP + rng.normal(0, 0.06, 3))
    bends = unit(rng.choice([-1.0, 1.0], p=[0.2, 0.8]) * (np.cos(raised) * away + np.sin(raised) * _UP) - [0, 0, 0.6])
    side = unit(bends - (bends @ u) * u)
    f = np.cos(bend) * u + np.sin(bend) * side
    return _arm(rng, u, f, 0.4, 0.6)


def reaching_arm(rng: np.random.Generator, sign: float) -> ArmPose:
    """An arm towards the sensor, straight or half bent."""
    u = unit(np.array([sign * rng.normal(0.1, 0.25), rng.normal(-0.15, 0.35), -1.0]))
    f = unit(u + np.array([sign * rng.normal(-0.1, 0.25), rng.normal(0.15, 0.3), 0.0]))
    return _arm(rng, u, f, 0.5, 0.7)


def engaging_arm(rng: np.random.Generator, sign: float) -> ArmPose:
    """An open hand beside the head, elbow bent, palm to the front."""
    u = unit(np.array([sign * rng.uniform(0.5, 1.2), rng.uniform(-0.8, 0.25), rng.uniform(-0.5, 0.1)]))
    f = unit(np.array([sign * rng.normal(0.0, 0.22), 1.0, rng.normal(-0.15, 0.2)]))
    palm = unit(np.array([rng.normal(0, 0.25), rng.normal(0.05, 0.2), -1.0]))
    return ArmPose(u, f, palm=palm, curl=float(rng.uniform(0, 0.15)), spread_rad=float(rng.uniform(0, 0.18)))


def crossed_arm(rng: np.random.Generator, sign: float) -> ArmPose:
    """A forearm across the chest (both together: the body stop)."""
    u = unit(np.array([sign * rng.uniform(0.0, 0.4), -1.0, -rng.uniform(0.25, 0.8)]))
    f = unit(np.array([-sign * rng.uniform(0.7, 1.3), rng.uniform(0.2, 1.1), -rng.uniform(0.1, 0.5)]))
    return _arm(rng, u, f, 0.5, 0.4)


def standing_legs(rng: np.random.Generator) -> tuple[LegPose, LegPose]:
    """Legs together or apart (0..40 degrees between them), sometimes one put forward or back, knees a little bent."""
    apart = np.radians(rng.uniform(0, 40) if rng.uniform() < 0.6 else rng.uniform(0, 8)) / 2
    stride = np.radians(rng.uniform(-35, 35)) if rng.uniform() < 0.3 else np.radians(rng.normal(0, 4))
    legs = []
    for sign in (1.0, -1.0):
        forward = sign * stride / 2
        knee = max(0.0, rng.normal(0.03, 0.06)) + max(0.0, forward) * rng.uniform(0, 0.8)
        side = apart + rng.normal(0, 0.02)
        t = unit(np.array([sign * np.tan(side), -1.0, -np.tan(forward + 0.6 * knee)]))
        s = unit(np.array([sign * np.tan(side * rng.uniform(0.7, 1.1)), -1.0, -np.tan(forward - 0.6 * knee)]))
        toes = yaw(-sign * float(rng.uniform(0, 0.5))) @ np.array([0.0, 0.0, -1.0])
        legs.append(LegPose(t, s, toes))
    return legs[0], legs[1]


def _tilt(rng: np.random.Generator, spread: float) -> Floats:
    x, y, z = rng.normal(0, spread, 3)
    turn = rotation(_UP, y) @ rotation(np.array([1.0, 0.0, 0.0]), x)
    return turn @ rotation(np.array([0.0, 0.0, 1.0]), 0.6 * z)


ARMS = (hanging_arm, random_arm, plane_arm, reaching_arm, engaging_arm, crossed_arm)


def random_pose(rng: np.random.Generator) -> Pose:
    """A pose of an operator at work, from no data set; both arms of one kind in half of the cases."""
    weights = np.array([0.16, 0.36, 0.22, 0.10, 0.10, 0.06])
    kind = rng.choice(len(ARMS), p=weights)
    other = kind if rng.uniform() < 0.5 or kind == 5 else rng.choice(len(ARMS), p=weights)
    arms = (ARMS[kind](rng, 1.0), ARMS[other](rng, -1.0))
    if rng.uniform() < 0.5:
        arms = (ARMS[other](rng, 1.0), ARMS[kind](rng, -1.0))
    pelvis = _tilt(rng, 0.05)
    chest = pelvis @ _tilt(rng, 0.09)
    return Pose(arms, standing_legs(rng), pelvis, chest, chest @ _tilt(rng, 0.2))


def jittered(pose: Pose, rng: np.random.Generator, spread: float) -> Pose:
    """The same pose with limb directions disturbed by about ``spread`` radians."""

    def shake(v: Floats) -> Floats:
        return unit(v + rng.normal(0, spread, 3))

    arms = [_arm(rng, shake(a.upper), shake(a.fore), 0.4, 0.6) for a in pose.arms]
    legs = [LegPose(shake(leg.thigh), shake(leg.shin), leg.toes) for leg in pose.legs]
    return Pose((arms[0], arms[1]), (legs[0], legs[1]), pose.pelvis, pose.chest, pose.head)
