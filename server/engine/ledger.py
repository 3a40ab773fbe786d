"""Latency per stage: percentiles over the last frames, in milliseconds."""

from __future__ import annotations

import threading
from collections import deque

from server.wire import StageLatency

STAGES = ("capture", "tracking", "filter", "intent", "simulation", "encode", "send", "paint", "total", "motion")
"""capture: from receipt until the engine takes the frame. filter: the delay the joint filter adds (group delay).
encode: state to JSON. send: from the state's being ready to the client's word, without the client's own time, so
queue and way back are included. paint: from the client's receipt of the state to its being painted. total: from
receipt to the client's word that the overlay is painted, by the server's clock, so the way back is included.
motion: total and the filter's delay of that frame, what the operator feels."""


class Ledger:
    """Thread-safe; one window of samples per stage."""

    def __init__(self, window: int) -> None:
        self._window = window
        self._samples: dict[str, deque[float]] = {}
        self._lock = threading.Lock()

    def add(self, stage: str, seconds: float) -> None:
        """One sample of one stage."""
        with self._lock:
            self._samples.setdefault(stage, deque(maxlen=self._window)).append(seconds * 1e3)

    def last_s(self, stage: str) -> float:
        """The newest sample of a stage in seconds, 0 without any."""
        with self._lock:
            samples = self._samples.get(stage)
            return samples[-1] / 1e3 if samples else 0.0

    def table(self) -> dict[str, StageLatency]:
        """Percentiles [ms] of every stage that has samples, in the order of the data flow."""
        with self._lock:
            copies = {stage: list(self._samples[stage]) for stage in STAGES if stage in self._samples}
        return {stage: _percentiles(samples) for stage, samples in copies.items()}

    def clear(self) -> None:
        """Start anew (another source)."""
        with self._lock:
            self._samples.clear()


def _percentiles(samples: list[float]) -> StageLatency:
    """Nearest-rank percentiles; milliseconds rounded to microseconds."""
    ordered = sorted(samples)
    at = [ordered[min(len(ordered) - 1, int(q * len(ordered)))] for q in (0.5, 0.95)]
    return StageLatency(p50=round(at[0], 3), p95=round(at[1], 3), last=round(samples[-1], 3))
