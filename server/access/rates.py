"""How often something may happen: a token bucket per peer. Pure: time comes in as an argument."""

from __future__ import annotations

from collections import OrderedDict

_REMEMBERED = 4096


class Rates:
    """``per_s`` on average, ``burst`` at once, for each key on its own; the longest idle keys are forgotten."""

    def __init__(self, per_s: float, burst: int) -> None:
        self._per_s = per_s
        self._burst = float(burst)
        self._buckets: OrderedDict[str, tuple[float, float]] = OrderedDict()

    def wait_s(self, key: str, now_s: float) -> float:
        """0 when it may happen now (and counts); else how long to wait [s]."""
        left = self._left(key, now_s)
        if left < 1.0:
            return (1.0 - left) / self._per_s
        self._keep(key, left - 1.0, now_s)
        return 0.0

    def _left(self, key: str, now_s: float) -> float:
        left, at_s = self._buckets.get(key, (self._burst, now_s))
        return min(self._burst, left + (now_s - at_s) * self._per_s)

    def _keep(self, key: str, left: float, now_s: float) -> None:
        self._buckets[key] = (left, now_s)
        self._buckets.move_to_end(key)
        while len(self._buckets) > _REMEMBERED:
            self._buckets.popitem(last=False)
