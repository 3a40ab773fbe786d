"""Picking or spraying, and the head camera's servo, from the legs (source eq. 8-13)."""

from __future__ import annotations

from dataclasses import dataclass, field

from teleop.borders import Border, Switch, step_switch
from teleop.config.intent import TaskConfig
from teleop.intent_types import Mode


@dataclass(frozen=True, slots=True)
class TaskState:
    """Memory of the leg features; a fresh one is taken on every entry to the working zone."""

    apart: Switch = field(default_factory=Switch)
    stride: Switch = field(default_factory=Switch)
    stride_s: float = 0.0
    head_camera_sweep: bool = False

    @property
    def task(self) -> Mode | None:
        """PICKING or SPRAYING; None while the legs have not told."""
        if self.apart.above is None:
            return None
        return Mode.PICKING if self.apart.above else Mode.SPRAYING


def step_task(
    state: TaskState, T1_deg: float | None, T2_deg: float | None, dt_s: float, config: TaskConfig
) -> TaskState:
    """One frame in the working zone; unknown angles change nothing."""
    border = Border(
        config.margin_deg, config.evidence_deg_s, config.clip_deg, config.noise_deg, config.quiet, config.noise_memory_s
    )
    apart = step_switch(state.apart, T1_deg, config.T1_deg, dt_s, border)
    stride = step_switch(state.stride, T2_deg, config.T2_deg, dt_s, border)
    stride_s = state.stride_s + dt_s if stride.above else 0.0
    return TaskState(apart, stride, stride_s, stride_s > config.T2_hold_s)
