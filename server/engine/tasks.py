"""The assisted picks of this server: how each stands, for whoever asks; and who waits for an answer."""

from __future__ import annotations

import threading
import time
from collections import OrderedDict
from collections.abc import Callable
from concurrent.futures import Future

from robot_sim.plants import Fruit
from server import wire
from server.errors import Refused
from teleop.assist.step import AssistState
from teleop.assist.task import PickTask
from teleop.reasons import Reason

KEPT = 100
ACTIVE = frozenset({"preview", "running"})


class Tasks:
    """Written by the engine's thread, read by any."""

    def __init__(self, fruits: tuple[Fruit, ...], clock: Callable[[], float] = time.time) -> None:
        self._unripe = frozenset(fruit.name for fruit in fruits if not fruit.ripe)
        self._clock = clock
        self._lock = threading.Lock()
        self._tasks: OrderedDict[str, wire.TaskState] = OrderedDict()
        self._current: str | None = None
        self._waiting: dict[str, Future[wire.TaskState]] = {}

    def all(self) -> list[wire.TaskState]:
        """Newest first."""
        with self._lock:
            return list(reversed(self._tasks.values()))

    def find(self, task_id: str) -> wire.TaskState:
        """One task. Raises Refused (404)."""
        with self._lock:
            found = self._tasks.get(task_id)
        if found is None:
            raise Refused(404, f"no task '{task_id[:40]}'; GET /api/v1/tasks lists those that are known")
        return found

    @property
    def current(self) -> wire.TaskState | None:
        """The one that holds the robot, or held it last."""
        with self._lock:
            return None if self._current is None else self._tasks.get(self._current)

    def active(self, fruit: str | None) -> wire.TaskState | None:
        """The task under way, when it is for this fruit (None: for whichever)."""
        now = self.current
        return now if now is not None and now.status in ACTIVE and fruit in (None, now.fruit) else None

    def expect(self, task_id: str) -> Future[wire.TaskState]:
        """The task as it stands after the step that it is asked of."""
        future: Future[wire.TaskState] = Future()
        self._waiting[task_id] = future
        return future

    def observe(self, assist: AssistState) -> None:
        """Take over how the tasks stand after a step; one that the engine knows no more was cut off."""
        now_s = self._clock()
        with self._lock:
            for task in (*assist.ended, *((assist.task,) if assist.task else ())):
                self._tasks[task.id] = self._state(task, self._tasks.get(task.id), now_s)
            self._current = assist.task.id if assist.task else self._current
            under_way = assist.active.id if assist.active else None
            for known in [t for t in self._tasks.values() if t.status in ACTIVE and t.id != under_way]:
                cut_off = {"status": "cancelled", "reason": str(Reason.ASSIST_RESTARTED), "ended": now_s}
                self._tasks[known.id] = known.model_copy(update=cut_off)
            while len(self._tasks) > KEPT:
                self._tasks.popitem(last=False)
            answered = [(self._waiting.pop(k), self._tasks[k]) for k in list(self._waiting) if k in self._tasks]
        for future, state in answered:
            if future.set_running_or_notify_cancel():
                future.set_result(state)

    def _state(self, task: PickTask, before: wire.TaskState | None, now_s: float) -> wire.TaskState:
        if before is not None and before.ended is not None:
            return before
        started = before.started if before else None
        return wire.TaskState(
            id=task.id,
            fruit=task.fruit,
            ripe=task.fruit not in self._unripe,
            status=task.status.value,
            stage=None if task.stage is None else task.stage.value,
            progress=round(task.progress, 3),
            attended=task.attended,
            confirmed=task.confirmation.confirmed,
            reason=task.reason,
            detail=task.detail,
            drive_m=None if task.plan is None else round(task.plan.drive_m, 3),
            forward_m=None if task.forward_m is None else round(task.forward_m, 3),
            created=before.created if before else round(now_s, 3),
            started=round(now_s, 3) if started is None and task.run is not None else started,
            ended=None if task.active else round(now_s, 3),
        )
