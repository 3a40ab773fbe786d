"""Which fruit the operator's arm points at: the direction of their arm, laid at the robot's right shoulder."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from robot_sim.config import RobotConfig
from robot_sim.stance import Stance
from robot_sim.urdf_parts_arms import shoulder_pose
from teleop.angles import angle_deg
from teleop.config.assist import AssistConfig
from teleop.intent_types import Side
from teleop.mapping import bone_forward_outward_up
from teleop.skeleton import Skeleton

F64 = npt.NDArray[np.float64]
LINGERS_S = 0.3
"""Half of this and of ``aim_begin_s``: so long the hand may be out of sight."""


@dataclass(frozen=True, slots=True)
class Aim:
    """Memory of aiming. raised_s: how long the other hand has been beside the head. direction: smoothed, in chest axes
    (forward, left, up). held_s: how long the same fruit, or none, has been meant. armed: the hand was away since the
    last aim."""

    raised_s: float = 0.0
    direction: tuple[float, float, float] | None = None
    fruit: str | None = None
    held_s: float = 0.0
    armed: bool = True

    def progress(self, config: AssistConfig) -> float:
        """Share 0..1 of the time that opens the preview."""
        return min(1.0, self.held_s / config.aim_s)


def arm_direction(body: Skeleton, side: Side, config: AssistConfig) -> F64 | None:
    """Where a nearly straight arm points: unit vector (3,) in chest axes (forward, left, up); None for a bent one."""
    shoulder, elbow, wrist = (body.joint(f"{name}_{side}") for name in ("shoulder", "elbow", "wrist"))
    if shoulder is None or elbow is None or wrist is None:
        return None
    bend = angle_deg(shoulder - elbow, wrist - elbow)
    length = float(np.linalg.norm(wrist - shoulder))
    if bend is None or bend < config.straight_deg or length < 1e-6:
        return None
    forward, outward, up = bone_forward_outward_up(wrist - shoulder, side)
    # the robot's right arm is meant, whichever of the operator's drives it
    return np.array([forward, -outward, up]) / length


def pointed_at(
    direction: F64,
    stance: Stance,
    fruits: Mapping[str, Sequence[float]],
    before: str | None,
    robot: RobotConfig,
    config: AssistConfig,
) -> str | None:
    """The fruit nearest to the line of the arm, within the cone; the one meant before stays unless another is nearer
    by ``keep_deg``. fruits: name -> middle (3,) in the world [m]."""
    shoulder = np.array(shoulder_pose("right", robot)[0])
    names = sorted(fruits)
    if not names:
        return None
    away = stance.to_disc(np.array([fruits[name] for name in names]), robot) - shoulder
    far = np.linalg.norm(away, axis=1)
    off = np.degrees(np.arccos(np.clip(away @ direction / np.maximum(far, 1e-6), -1.0, 1.0)))
    off = np.where(far <= config.far_m, off, np.inf)
    best = int(np.argmin(off))
    if before in names and off[names.index(before)] <= min(config.cone_deg, off[best] + config.keep_deg):
        return before
    return names[best] if off[best] <= config.cone_deg else None


def step_aim(
    aim: Aim,
    raised: bool,
    direction: F64 | None,
    choose: Callable[[F64, str | None], str | None],
    dt_s: float,
    config: AssistConfig,
) -> tuple[Aim, str | None]:
    """One frame. raised: the other hand is beside the head. choose: fruit of a direction, given the one before.

    Returns the memory, and what was decided now: a fruit, or "" for none; None while nothing is.
    """
    if not raised:
        # a moment without the hand does not end the aim, but one that was used must be let go first
        left_s = max(0.0, aim.raised_s - 2.0 * dt_s)
        return (Aim() if left_s <= 0.0 else replace(aim, raised_s=left_s)), None
    raised_s = min(aim.raised_s + dt_s, config.aim_begin_s + LINGERS_S)
    if not aim.armed or raised_s < config.aim_begin_s:
        return replace(aim, raised_s=raised_s), None
    mixed = _smoothed(aim, direction, dt_s, config)
    fruit = None if mixed is None else choose(np.array(mixed), aim.fruit)
    held_s = aim.held_s + dt_s if fruit == aim.fruit else 0.0
    if held_s < config.aim_s:
        return Aim(raised_s, mixed, fruit, held_s), None
    return Aim(raised_s, armed=False), fruit or ""


def _smoothed(aim: Aim, direction: F64 | None, dt_s: float, config: AssistConfig) -> tuple[float, float, float] | None:
    """The pointing direction with the new one mixed in; None when there is none."""
    if direction is None:
        return None
    if aim.direction is None or config.smoothing_s <= 0.0:
        mixed = direction
    else:
        share = 1.0 - math.exp(-dt_s / config.smoothing_s)
        mixed = np.array(aim.direction) + share * (direction - np.array(aim.direction))
        mixed = mixed / max(float(np.linalg.norm(mixed)), 1e-9)
    x, y, z = mixed.tolist()
    return x, y, z
