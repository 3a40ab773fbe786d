"""Workers on this machine: one process each, fed through a pipe; a worker that dies takes only its own task along.

(concurrent.futures gives up all tasks when one process dies, multiprocessing.Pool waits for it for ever.)
"""

from __future__ import annotations

import ctypes
import multiprocessing
import os
import signal
import sys
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from multiprocessing.connection import Connection, wait
from typing import Any, TypeVar

from teleop.parallel.outcome import Outcome, WorkerLost, attempt

T = TypeVar("T")
R = TypeVar("R")

_PR_SET_PDEATHSIG = 1
_ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OPENCV_FOR_THREADS_NUM")


class LocalPool:
    """Processes of one thread each, started when they are first needed."""

    def __init__(self, workers: int) -> None:
        self._workers = max(1, workers)
        self._idle: list[_Worker] = []

    @property
    def workers(self) -> int:
        """How many processes there will be."""
        return self._workers

    def run(self, work: Callable[[T], R], tasks: Sequence[T]) -> Iterator[Outcome[T, R]]:
        """Outcomes as they come. Leaving the iteration early kills the processes that are busy."""
        waiting = deque(enumerate(tasks))
        busy: dict[Connection, tuple[_Worker, int]] = {}
        try:
            while waiting or busy:
                while waiting and len(busy) < self._workers:
                    number, task = waiting.popleft()
                    worker = self._idle.pop() if self._idle else _Worker()
                    busy[worker.pipe] = worker, number
                    worker.give(work, task)
                for pipe in wait(list(busy)):
                    assert isinstance(pipe, Connection)
                    worker, number = busy.pop(pipe)
                    yield self._outcome(worker, number, tasks[number])
        finally:
            for worker, _ in busy.values():
                worker.kill()

    def close(self) -> None:
        """End the processes."""
        while self._idle:
            self._idle.pop().kill()

    def _outcome(self, worker: _Worker, number: int, task: Any) -> Outcome[Any, Any]:
        try:
            result, error = worker.pipe.recv()
        except EOFError:
            return Outcome(number, task, error=WorkerLost(worker.epitaph()))
        self._idle.append(worker)
        return Outcome(number, task, result, error)


class _Worker:
    """One process and our end of its pipe."""

    def __init__(self) -> None:
        # a fresh interpreter: a fork would copy the threads' locks of the recorder's and the progress bar's libraries
        context = multiprocessing.get_context("spawn")
        self.pipe, theirs = context.Pipe()
        self._process = context.Process(target=_serve, args=(theirs, os.getpid()), daemon=True)
        self._process.start()
        theirs.close()

    def give(self, work: Callable[[Any], Any], task: Any) -> None:
        try:
            self.pipe.send((work, task))
        except BrokenPipeError:
            return  # it died while it was idle: reading from the pipe tells

    def epitaph(self) -> str:
        """Why it is gone."""
        self._process.join()
        code = self._process.exitcode or 0
        self.pipe.close()
        how = f"by {signal.Signals(-code).name}" if code < 0 else f"with exit code {code}"
        return f"its process ended {how} in the middle" + (" (out of memory?)" if code == -signal.SIGKILL else "")

    def kill(self) -> None:
        self._process.kill()
        self._process.join()
        self.pipe.close()


def _serve(pipe: Connection, parent: int) -> None:
    """The worker's loop, until its parent closes the pipe or dies."""
    _die_with(parent)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the parent, too, and that one decides
    os.environ.update(dict.fromkeys(_ONE_THREAD, "1"))
    if "numba" not in sys.modules:
        os.environ["NUMBA_NUM_THREADS"] = "1"
    while True:
        try:
            work, task = pipe.recv()
        except EOFError:
            return
        pipe.send(attempt(work, task))


def _die_with(parent: int) -> None:
    """Have the kernel kill this process when its parent is gone, however that ended (prctl(2))."""
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        sys.exit(1)
