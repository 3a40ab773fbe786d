"""One assisted pick as a task: what was asked, how it stands, how it ended."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum

from robot_sim.config import RobotConfig
from robot_sim.pick.plan import PickPlan, Scenery
from robot_sim.pick.run import PickRun, Stage
from robot_sim.pick.run import progress as run_progress
from robot_sim.state import RobotState


class TaskStatus(StrEnum):
    """PREVIEW: planned and shown, waiting for the confirmation. The first two are under way, the others are ends."""

    PREVIEW = "preview"
    RUNNING = "running"
    SUCCEEDED = "succeeded"
    FAILED = "failed"
    REFUSED = "refused"
    CANCELLED = "cancelled"
    TAKEN_OVER = "taken_over"


ACTIVE = frozenset({TaskStatus.PREVIEW, TaskStatus.RUNNING})


@dataclass(frozen=True, slots=True)
class Confirmation:
    """The left hand over a preview: it must be seen open before its fist counts; confirmed as long as it is closed."""

    was_open: bool = False
    confirmed: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class PickTask:
    """attended: an operator is in control and must keep both hands closed. reason, detail: why it ended as it did, and
    what to do. forward_m: the drive that would help. opened_s: the robot's time when the preview opened. unread_s: how
    long the hands have not been read."""

    id: str
    fruit: str
    attended: bool
    status: TaskStatus
    reason: str = ""
    detail: str = ""
    forward_m: float | None = None
    plan: PickPlan | None = None
    run: PickRun | None = None
    opened_s: float = 0.0
    confirmation: Confirmation = Confirmation()
    unread_s: float = 0.0

    @property
    def active(self) -> bool:
        """Whether it holds the robot."""
        return self.status in ACTIVE

    @property
    def stage(self) -> Stage | None:
        """Where the pick is, or was when it ended; None before it began."""
        return None if self.run is None else self.run.stage

    @property
    def progress(self) -> float:
        """Share 0..1 that is done."""
        return 0.0 if self.run is None else run_progress(self.run)

    def ended(self, status: TaskStatus, reason: str, detail: str = "") -> PickTask:
        """The task with its end."""
        return replace(self, status=status, reason=str(reason), detail=detail)


@dataclass(frozen=True, slots=True, eq=False)
class RobotView:
    """What the assisted pick knows of the robot: its last report, its configuration, the greenhouse around it."""

    state: RobotState
    config: RobotConfig
    scenery: Scenery
