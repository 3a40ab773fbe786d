"""How late the server's event loop is: a timer that asks to be woken often and notes when it was."""

from __future__ import annotations

import asyncio
import time
from collections import deque

_EVERY_S = 0.01
_KEPT = 6000
"""Samples looked back on: a minute."""


class LoopLag:
    """Runs in the loop it watches; :meth:`quantiles_s` may be called from any thread."""

    def __init__(self) -> None:
        self._late_s: deque[float] = deque(maxlen=_KEPT)
        self.worst_s = 0.0

    async def watch(self) -> None:
        """Measure until cancelled."""
        while True:
            due_s = time.monotonic() + _EVERY_S
            await asyncio.sleep(_EVERY_S)
            late_s = max(0.0, time.monotonic() - due_s)
            self._late_s.append(late_s)
            self.worst_s = max(self.worst_s, late_s)

    def quantiles_s(self, *wanted: float) -> list[float]:
        """Nearest-rank quantiles over the last minute [s]; zeros before the first sample."""
        ordered = sorted(self._late_s.copy())
        if not ordered:
            return [0.0] * len(wanted)
        return [ordered[min(len(ordered) - 1, int(q * len(ordered)))] for q in wanted]
