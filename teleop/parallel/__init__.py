"""Many like tasks at once: on all cores of this machine, or on a Dask cluster, behind one small interface."""

from teleop.parallel.opening import open_pool
from teleop.parallel.outcome import Outcome, Pool, WorkerLost, in_order

__all__ = ["Outcome", "Pool", "WorkerLost", "in_order", "open_pool"]
