"""The run so far: metrics and the events of the last step. Pure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from robot_sim.events import RobotEvent, RobotEventKind
from robot_sim.metrics import RunMetrics, fruit_events, moved_on
from robot_sim.state import RobotState


@dataclass(frozen=True, slots=True)
class Touching:
    """What touches now. arms: pairs of links. obstacle: the robot presses against something that stands."""

    arms: frozenset[tuple[str, str]] = frozenset()
    obstacle: bool = False


@dataclass(frozen=True, slots=True)
class RunLog:
    """metrics since the reset; last: the state they reach up to; events of the last step."""

    last: RobotState
    metrics: RunMetrics = field(default_factory=RunMetrics)
    touching: Touching = field(default_factory=Touching)
    events: tuple[RobotEvent, ...] = ()


def logged(
    log: RunLog, state: RobotState, work_j: float, now: Touching, cut: Sequence[str], unripe: frozenset[str]
) -> RunLog:
    """The log after one step. cut: fruit whose peduncle was cut in it."""
    t = state.sim_time_s
    events = [RobotEvent(t, RobotEventKind.CUT, name) for name in cut]
    events += fruit_events(log.last.fruits, state.fruits, t)
    events += [RobotEvent(t, RobotEventKind.ARM_CONTACT, f"{a} {b}") for a, b in sorted(now.arms - log.touching.arms)]
    if now.obstacle and not log.touching.obstacle:
        events.append(RobotEvent(t, RobotEventKind.OBSTACLE, "chassis"))
    events += [
        RobotEvent(t, RobotEventKind.TANK_EMPTY, liquid)
        for liquid, level in state.tank_l.items()
        if level <= 0.0 < log.last.tank_l.get(liquid, level)
    ]
    return RunLog(state, moved_on(log.metrics, log.last, state, work_j, events, unripe), now, tuple(events))
