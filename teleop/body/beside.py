"""Work that goes on beside: on the tracker's second thread while the first does something else."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from typing import TypeVar, TypeVarTuple

R = TypeVar("R")
T = TypeVarTuple("T")


def later(beside: Executor | None, work: Callable[[*T], R], *args: *T) -> Callable[[], R]:
    """The work's result, or what it raised, once it is asked for.

    Where there is nobody beside it is done, and raises, at once.
    """
    if beside is None:
        known = work(*args)
        return lambda: known
    return beside.submit(work, *args).result
