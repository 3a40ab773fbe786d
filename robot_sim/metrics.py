"""What a run has come to: time, fruit, contacts, distance, energy, spray. Pure."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from math import hypot, remainder, tau

from robot_sim.events import RobotEvent, RobotEventKind
from robot_sim.state import RobotState


@dataclass(frozen=True, slots=True)
class RunMetrics:
    """Counted since the last reset.

    distance_m, turned_rad: of the chassis. energy_j: mechanical work of all motors, |torque x speed|, sampled every
    control step. picked: fruit in the box now; unripe: those of them that are not ripe. dropped: on the floor now.
    damaged: all. arm_contacts, obstacle_contacts: how often one began. sprayed_l, coverage: per liquid; coverage is the
    wet share 0..1 of all leaf area. overspray, wrong_liquid: share 0..1 of all that was sprayed which hit no leaf, and
    which hit a leaf that wants another liquid (mildew wants pesticide, healthy leaves anything else).
    """

    time_s: float = 0.0
    distance_m: float = 0.0
    turned_rad: float = 0.0
    energy_j: float = 0.0
    picked: int = 0
    unripe: int = 0
    dropped: int = 0
    damaged: int = 0
    cut: int = 0
    arm_contacts: int = 0
    obstacle_contacts: int = 0
    sprayed_l: Mapping[str, float] = field(default_factory=dict)
    coverage: Mapping[str, float] = field(default_factory=dict)
    overspray: float = 0.0
    wrong_liquid: float = 0.0


def moved_on(
    metrics: RunMetrics,
    before: RobotState,
    after: RobotState,
    work_j: float,
    events: Iterable[RobotEvent],
    unripe: frozenset[str],
) -> RunMetrics:
    """Metrics after one step; unripe: names of the fruit that should have been left."""
    kinds = [event.kind for event in events]
    fruit = {name: status.removesuffix("+damaged") for name, status in after.fruits.items()}
    boxed = [name for name, status in fruit.items() if status == "boxed"]
    return replace(
        metrics,
        time_s=metrics.time_s + after.sim_time_s - before.sim_time_s,
        distance_m=metrics.distance_m + hypot(after.base_x_m - before.base_x_m, after.base_y_m - before.base_y_m),
        turned_rad=metrics.turned_rad + abs(remainder(after.base_yaw_rad - before.base_yaw_rad, tau)),
        energy_j=metrics.energy_j + work_j,
        picked=len(boxed),
        unripe=len(unripe.intersection(boxed)),
        dropped=sum(status == "dropped" for status in fruit.values()),
        damaged=sum(status.endswith("+damaged") for status in after.fruits.values()),
        cut=metrics.cut + kinds.count(RobotEventKind.CUT),
        arm_contacts=metrics.arm_contacts + kinds.count(RobotEventKind.ARM_CONTACT),
        obstacle_contacts=metrics.obstacle_contacts + kinds.count(RobotEventKind.OBSTACLE),
    )


def fruit_events(before: Mapping[str, str], after: Mapping[str, str], t_s: float) -> list[RobotEvent]:
    """What became of fruit between two reports of RobotState.fruits."""
    kinds = (RobotEventKind.BOXED, RobotEventKind.DROPPED, RobotEventKind.DAMAGED)
    return [
        RobotEvent(t_s, kind, name)
        for name, status in after.items()
        for kind in kinds
        if str(kind) in status and str(kind) not in before.get(name, "")
    ]
