"""From what a user asks for to a pool of workers."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from teleop.parallel.local import LocalPool
from teleop.parallel.outcome import Pool


@contextmanager
def open_pool(workers: int | None, scheduler: str | None, software: Callable[[], str]) -> Iterator[Pool]:
    """Processes on this machine (``workers``, by default one per core), or the Dask cluster of ``scheduler``.

    software: a function of a module whose answer must be the same on every worker. Raises TeleopError.
    """
    pool: Pool
    if scheduler is None:
        pool = LocalPool(workers or len(os.sched_getaffinity(0)))
    else:
        from teleop.parallel.cluster import DaskPool

        pool = DaskPool(scheduler, software)
    try:
        yield pool
    finally:
        pool.close()
