"""What is known of the operator's body: levelled, gated, kept for a moment when lost, and still the same person."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from teleop.config.intent import IntentConfig, SafetyConfig
from teleop.impossible_bones import without_impossible_bones
from teleop.jumps import JumpState, aged, finite_only, initial_jumps, step_jumps
from teleop.level import Ground, levelled, rotation_level_camera, step_ground
from teleop.reasons import Reason
from teleop.skeleton import Skeleton, Track


@dataclass(frozen=True, slots=True, eq=False)
class Sight:
    """Memory and answer in one.

    body: the last gated, levelled skeleton of the operator; None when nobody is there. shown: this frame's levelled
    skeleton as tracked, ungated. lost_s: time since body was seen. place_m: the spine (3,) then, camera axes.
    exchanged: somebody else stands there now.
    """

    body: Skeleton | None = None
    shown: Skeleton | None = None
    lost_s: float = 0.0
    place_m: npt.NDArray[np.float64] | None = None
    exchanged: bool = False
    ground: Ground = field(default_factory=Ground)
    jumps: JumpState = field(default_factory=initial_jumps)
    reasons: tuple[Reason, ...] = ()

    @property
    def seen_now(self) -> bool:
        """Whether the operator is tracked in this very frame."""
        return self.body is not None and self.lost_s == 0.0


def _reach_m(config: SafetyConfig, age_s: float) -> float:
    """How far the trunk may be from where it was; a person lost for longer must come back near there."""
    return config.joint_slack_m + config.trunk_speed_m_s * min(age_s, config.lost_hold_s / 2)


def step_sight(sight: Sight, track: Track, dt_s: float, engaged: bool, config: IntentConfig) -> Sight:
    """One frame. An operator in control is kept for ``lost_disengage_s``, anybody else for ``lost_hold_s``."""
    ground = step_ground(sight.ground, track.floor, dt_s, config.level)
    doubts = (Reason.FLOOR_JUMP,) if ground.doubted else ()
    sight = replace(sight, ground=ground, shown=None, exchanged=False, reasons=doubts)
    if track.skeleton is None:
        return _lost(sight, dt_s, engaged, config.safety)
    R_level_camera = rotation_level_camera(ground.floor, config.level)
    finite, absurd = finite_only(track.skeleton, config.safety)
    sight = replace(sight, shown=levelled(finite, R_level_camera))
    spine_m = finite.joint("spine")
    if spine_m is None:
        sight = replace(sight, reasons=(*doubts, Reason.JOINT_NOT_FINITE) if absurd else doubts)
        return _lost(sight, dt_s, engaged, config.safety)
    exchanged = track.reset and sight.body is not None
    if sight.place_m is not None and not track.reset:
        age_s = sight.lost_s + dt_s
        if float(np.linalg.norm(spine_m - sight.place_m)) > _reach_m(config.safety, age_s):
            if age_s <= config.safety.lost_hold_s:
                return _lost(replace(sight, reasons=(*doubts, Reason.OPERATOR_JUMP)), dt_s, engaged, config.safety)
            exchanged = True
    jumps = initial_jumps() if exchanged or track.reset else sight.jumps
    gated, reasons, jumps = step_jumps(jumps, track.skeleton, dt_s, config.safety)
    gated, impossible = without_impossible_bones(gated, config.bones)
    reasons = (*doubts, *reasons, *((Reason.BONE_LENGTH,) if impossible else ()))
    if gated.joint("spine") is None:
        return _lost(replace(sight, reasons=reasons), dt_s, engaged, config.safety)
    return Sight(
        body=levelled(gated, R_level_camera),
        shown=sight.shown,
        place_m=spine_m,
        exchanged=exchanged,
        ground=ground,
        jumps=jumps,
        reasons=reasons,
    )


def _lost(sight: Sight, dt_s: float, engaged: bool, config: SafetyConfig) -> Sight:
    lost_s = sight.lost_s + dt_s
    sight = replace(sight, lost_s=lost_s, jumps=aged(sight.jumps, dt_s))
    if sight.body is None or lost_s > (config.lost_disengage_s if engaged else config.lost_hold_s):
        return Sight(shown=sight.shown, ground=sight.ground, reasons=sight.reasons)
    return sight
