"""Which colour image belongs to a depth image: the nearest in time, within half a frame."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

_MIN_TOLERANCE_NS = 20_000_000
"""For sources of one frame, and for jitter: a little more than half a frame at 30 frames/s."""


class NearestInTime:
    """Finds the nearest of the sorted times ``t_ns`` (N,), for queries that come with the times ``asked_ns``."""

    def __init__(self, t_ns: npt.NDArray[np.int64], asked_ns: npt.NDArray[np.int64]) -> None:
        self._t_ns = t_ns
        periods = [float(np.median(np.diff(t))) for t in (asked_ns, t_ns) if len(t) > 1]
        # Half the longer period: colour at half the depth rate still serves every depth image.
        self._tolerance_ns = max([_MIN_TOLERANCE_NS, *(p / 2 for p in periods)])

    def index(self, t_ns: int) -> int | None:
        """Index of the nearest time, or None when none lies within half a frame."""
        after = int(np.searchsorted(self._t_ns, t_ns))
        candidates = [i for i in (after - 1, after) if 0 <= i < len(self._t_ns)]
        if not candidates:
            return None
        best = min(candidates, key=lambda i: abs(int(self._t_ns[i]) - t_ns))
        return best if abs(int(self._t_ns[best]) - t_ns) <= self._tolerance_ns else None
