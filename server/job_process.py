"""Work of a job in a process of its own, of low priority: the robot's loop does not wait for it."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Callable, Mapping
from multiprocessing.connection import Connection
from typing import Any

from robot_sim.errors import RobotError
from server.jobs import JobCancelled, JobProgress
from teleop.errors import TeleopError

Report = Callable[[float], None]
"""How much is done, 0 to 1."""
_POLL_S = 0.1
_NICENESS = 10


def in_process(work: Callable[..., Mapping[str, Any]], arguments: tuple[Any, ...], progress: JobProgress) -> Any:
    """Run ``work(*arguments, report)``, a function of a module, elsewhere; what it returns comes back.

    Raises TeleopError when the work does, or when its process dies; JobCancelled when the job is to end.
    """
    context = multiprocessing.get_context("spawn")
    mine, theirs = context.Pipe(duplex=False)
    process = context.Process(target=_child, args=(work, arguments, theirs), daemon=True)
    process.start()
    theirs.close()
    try:
        while True:
            if progress.cancelled:
                raise JobCancelled
            if not mine.poll(_POLL_S):
                if process.is_alive() or mine.poll():
                    continue
                raise TeleopError(f"the job's process ended by itself (exit code {process.exitcode})")
            kind, content = mine.recv()
            if kind == "progress":
                progress.report(content)
            elif kind == "failed":
                raise TeleopError(content)
            else:
                return content
    except EOFError:
        process.join(1.0)
        raise TeleopError(f"the job's process ended by itself (exit code {process.exitcode})") from None
    except JobCancelled:
        process.terminate()
        raise
    finally:
        process.join(5.0)
        if process.is_alive():
            process.kill()
            process.join()
        mine.close()


def _child(work: Callable[..., Mapping[str, Any]], arguments: tuple[Any, ...], answer: Connection) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the server, which ends its jobs in order
    os.nice(_NICENESS)
    told = -1.0

    def report(share: float) -> None:
        nonlocal told
        if share - told >= 0.005:
            told = share
            answer.send(("progress", share))

    try:
        result = dict(work(*arguments, report))
    except (TeleopError, RobotError, OSError) as error:
        answer.send(("failed", str(error)))
    else:
        answer.send(("done", result))
    answer.close()
