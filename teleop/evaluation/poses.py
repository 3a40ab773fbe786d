"""Poses of the evaluation: the source's protocol at given angles, free arms over the full reach, legs apart."""

from __future__ import annotations

from typing import Final, Literal

import numpy as np

from teleop.people.pose import ArmPose, LegPose, Pose, rotation, unit, yaw
from teleop.people.rig import Floats

Kind = Literal["free", "forward", "sideways", "elbow_forward", "elbow_across", "bins", "legs"]
"""free: arms anywhere. forward, sideways: both upper arms raised by the level in the sagittal, frontal plane.
elbow_*: inner angle of the elbow is the level, the forearm towards the sensor or across its view. bins: like forward
or sideways at any angle. legs: the level between the thighs, arms free."""
PROTOCOL: Final[dict[Kind, tuple[float, ...]]] = {
    "forward": tuple(range(10, 100, 10)),
    "sideways": tuple(range(10, 100, 10)),
    "elbow_forward": tuple(range(90, 190, 10)),
    "elbow_across": tuple(range(90, 190, 10)),
}
"""Levels in degrees of the source's experiment (its section 4.2, figure 12)."""

_DOWN: Final = np.array([0.0, -1.0, 0.0])
_FRONT: Final = np.array([0.0, 0.0, -1.0])


def _outward(sign: float) -> Floats:
    return np.array([sign, 0.0, 0.0])


def raised(sign: float, sideways_deg: float, forward_deg: float) -> Floats:
    """Direction (3,) of an upper arm whose projected angles are theta1 = sideways and theta2 = forward.

    An angle of 90 degrees or more is only possible in one of the two; it is then taken as the turn in its own plane.
    """
    if max(sideways_deg, forward_deg) < 85.0:
        tangents = np.tan(np.radians([sideways_deg, forward_deg]))
        return unit(_DOWN + tangents[0] * _outward(sign) + tangents[1] * _FRONT)
    a, plane = (sideways_deg, _outward(sign)) if sideways_deg > forward_deg else (forward_deg, _FRONT)
    return np.asarray(np.cos(np.radians(a)) * _DOWN + np.sin(np.radians(a)) * plane)


def bent(upper: Floats, elbow_deg: float, towards: Floats) -> Floats:
    """Direction (3,) of a forearm at an inner elbow angle, folded towards a direction."""
    side = towards - (towards @ upper) * upper
    fold = np.radians(180.0 - elbow_deg)
    return np.asarray(np.cos(fold) * upper + np.sin(fold) * unit(side))


def _arm(rng: np.random.Generator, upper: Floats, fore: Floats) -> ArmPose:
    curl = float(rng.choice([rng.uniform(0, 0.12), rng.uniform(0.15, 0.45), rng.uniform(0.85, 1.0)]))
    turned = float(np.clip(rng.normal(0.4, 0.5), -1.4, 1.5))
    return ArmPose(upper, fore, pronation_rad=turned, curl=curl, spread_rad=float(rng.uniform(0, 0.15)))


def hanging_arm(rng: np.random.Generator, sign: float) -> ArmPose:
    """An arm at rest beside the body."""
    upper = raised(sign, float(rng.uniform(4, 14)), float(rng.uniform(0, 8)))
    return _arm(rng, upper, bent(upper, float(rng.uniform(160, 177)), _FRONT - 0.3 * _outward(sign)))


def free_directions(rng: np.random.Generator, sign: float) -> tuple[Floats, Floats]:
    """Upper arm and forearm anywhere a shoulder and an elbow reach before the body's back."""
    while True:
        upper = unit(rng.normal(0, 1, 3))
        out, up, back = sign * upper[0], upper[1], upper[2]
        if back < 0.3 and out > -0.45 and up < 0.85 and not (out < -0.1 and back > -0.4):
            break
    elbow = float(rng.uniform(55, 178))
    for _ in range(60):
        fore = bent(upper, elbow, unit(rng.normal(0, 1, 3)))
        # a forearm folds to the front, to the middle or upwards; not outwards and back
        fold = fore - (fore @ upper) * upper
        if fold[2] < 0.25 * np.linalg.norm(fold) and sign * fore[0] > -0.75 and fore[2] < 0.4:
            break
    return upper, fore


def legs_apart(rng: np.random.Generator, apart_deg: float, stride_deg: float) -> tuple[LegPose, LegPose]:
    """Legs whose thighs stand apart_deg from each other in the frontal, stride_deg in the sagittal plane."""
    legs = []
    lean = rng.normal(0, 1.0)
    for sign in (1.0, -1.0):
        side, ahead = np.radians(apart_deg / 2 + sign * lean), np.radians(sign * stride_deg / 2)
        thigh = unit(_DOWN + np.tan(side) * _outward(sign) + np.tan(ahead) * _FRONT)
        knee = max(0.0, float(rng.normal(0.03, 0.04)))
        shin = unit(_DOWN + np.tan(side * rng.uniform(0.7, 1.0)) * _outward(sign) + np.tan(ahead - knee) * _FRONT)
        legs.append(LegPose(thigh, shin, yaw(-sign * float(rng.uniform(0.05, 0.4))) @ _FRONT))
    return legs[0], legs[1]


def _tilt(rng: np.random.Generator, spread: float) -> Floats:
    x, y, z = rng.normal(0, spread, 3)
    turn = yaw(y) @ rotation(np.array([1.0, 0.0, 0.0]), x)
    return np.asarray(turn @ rotation(np.array([0.0, 0.0, 1.0]), 0.6 * z))


def upright(rng: np.random.Generator, arms: tuple[ArmPose, ArmPose], legs: tuple[LegPose, LegPose]) -> Pose:
    """A standing person with these limbs, trunk and head a little tilted and turned."""
    pelvis = _tilt(rng, 0.03)
    chest = pelvis @ _tilt(rng, 0.05)
    return Pose(arms, legs, pelvis, chest, chest @ _tilt(rng, 0.12))


def _protocol_arm(rng: np.random.Generator, sign: float, kind: Kind, level: float) -> ArmPose:
    off = float(rng.uniform(2, 8))
    if kind in ("forward", "sideways"):
        upper = raised(sign, level, off) if kind == "sideways" else raised(sign, off, level)
        fore = bent(upper, float(rng.uniform(165, 178)), _FRONT if kind == "sideways" else -_DOWN)
    elif kind == "elbow_forward":
        upper = raised(sign, float(rng.uniform(4, 14)), float(rng.uniform(5, 20)))
        fore = bent(upper, level, _FRONT + rng.normal(0, 0.1) * _outward(sign))
    else:
        upper = raised(sign, float(rng.uniform(45, 75)), off)
        fore = bent(upper, level, -_DOWN + float(rng.uniform(0.0, 0.5)) * _FRONT)
    return _arm(rng, upper, fore)


def _bin_arm(rng: np.random.Generator, sign: float) -> ArmPose:
    level, off = float(rng.uniform(0, 93)), float(rng.uniform(0, 15))
    upper = raised(sign, level, off) if rng.uniform() < 0.5 else raised(sign, off, level)
    fold = unit(rng.uniform(0.2, 1.0) * -_DOWN + rng.uniform(0, 1.0) * _FRONT - rng.uniform(0, 0.4) * _outward(sign))
    return _arm(rng, upper, bent(upper, float(rng.uniform(90, 178)), fold))


def pose_of(rng: np.random.Generator, kind: Kind, level: float) -> Pose:
    """A pose of a kind; level in degrees where the kind has one."""
    apart, stride = float(rng.uniform(0, 30)), float(rng.normal(0, 3))
    if kind == "free":
        limbs = [free_directions(rng, s) if rng.uniform() < 0.85 else None for s in (1.0, -1.0)]
        arms = [hanging_arm(rng, s) if d is None else _arm(rng, *d) for s, d in zip((1.0, -1.0), limbs, strict=True)]
    elif kind == "bins":
        arms = [_bin_arm(rng, s) for s in (1.0, -1.0)]
    elif kind == "legs":
        apart = level
        arms = [hanging_arm(rng, s) if rng.uniform() < 0.4 else _bin_arm(rng, s) for s in (1.0, -1.0)]
    else:
        apart = float(rng.uniform(2, 16))
        arms = [_protocol_arm(rng, s, kind, level) for s in (1.0, -1.0)]
    if kind == "free" and rng.uniform() < 0.25:
        stride = float(rng.uniform(-30, 30))
    return upright(rng, (arms[0], arms[1]), legs_apart(rng, apart, stride))
