"""What live drivers share: libraries that may be missing, clocks that wrap, stamps that must increase."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from types import ModuleType

from teleop.errors import SourceError
from teleop.frames import DepthFrame


def import_driver(module: str, package: str) -> ModuleType:
    """Import a sensor's Python package. Raises SourceError saying how to get it."""
    try:
        return importlib.import_module(module)
    except (ImportError, OSError) as error:
        raise SourceError(
            f"the Python package '{package}' is not usable ({error}); install it with "
            f"'pip install {package}', or run 'teleop doctor'"
        ) from None


def increasing(frames: Iterator[DepthFrame]) -> Iterator[DepthFrame]:
    """Leave out frames that are not newer than the one before (a driver that repeats its last buffer)."""
    last_ns: int | None = None
    for frame in frames:
        if last_ns is None or frame.t_ns > last_ns:
            last_ns = frame.t_ns
            yield frame


class TickClock:
    """Device ticks in a 32-bit counter that wraps, as nanoseconds that do not."""

    def __init__(self, ticks_per_s: int) -> None:
        self._ticks_per_s = ticks_per_s
        self._last: int | None = None
        self._total = 0

    def t_ns(self, ticks: int) -> int:
        """Nanoseconds since the first call; steps of less than half the counter's range may go either way."""
        if self._last is not None:
            step = (ticks - self._last) & 0xFFFFFFFF
            self._total += step - (1 << 32) if step >= 1 << 31 else step
        self._last = ticks
        return self._total * 1_000_000_000 // self._ticks_per_s
