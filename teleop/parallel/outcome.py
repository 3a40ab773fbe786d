"""What became of a task, and what every pool of workers can do."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from teleop.errors import TeleopError

T = TypeVar("T")
R = TypeVar("R")


class WorkerLost(TeleopError):
    """The worker ended in the middle of a task (killed, out of memory, crash of a C library)."""


@dataclass(frozen=True, slots=True)
class Outcome(Generic[T, R]):
    """One task and its result, or the error that it raised. number: its place among the tasks."""

    number: int
    task: T
    result: R | None = None
    error: Exception | None = None

    def value(self) -> R:
        """The result. Raises the task's own error."""
        if self.error is not None:
            raise self.error
        return self.result  # type: ignore[return-value]  # None is a legal result


class Pool(Protocol):
    """Workers. ``work`` and the tasks are pickled: ``work`` is a function of a module, a task plain data."""

    @property
    def workers(self) -> int:
        """How many tasks run at the same time."""
        ...

    def run(self, work: Callable[[T], R], tasks: Sequence[T]) -> Iterator[Outcome[T, R]]:
        """Outcomes as they come, in no order. Leaving the iteration early ends the tasks that run."""
        ...

    def close(self) -> None:
        """Let the workers go; safe to call twice."""
        ...


def in_order(outcomes: Iterable[Outcome[T, R]]) -> Iterator[Outcome[T, R]]:
    """The same outcomes in the order of their tasks; those that come too early are held back."""
    held: dict[int, Outcome[T, R]] = {}
    due = 0
    for outcome in outcomes:
        held[outcome.number] = outcome
        while due in held:
            yield held.pop(due)
            due += 1


def attempt(work: Callable[[T], R], task: T) -> tuple[R | None, Exception | None]:
    """Call ``work`` in a worker: its result, or its error with the worker's traceback as a note."""
    try:
        return work(task), None
    except TeleopError as error:
        return None, error
    except Exception as error:  # noqa: BLE001  carried to the caller, who raises or reports it
        error.add_note(traceback.format_exc())
        return None, error
