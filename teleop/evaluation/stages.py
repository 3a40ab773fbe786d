"""Where the time of a step goes: every function of the tracker's package timed without what it calls."""

from __future__ import annotations

import functools
import importlib
import pkgutil
import sys
import threading
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FunctionType, ModuleType
from typing import Any

import teleop.body

BESIDE = " (beside, in a thread)"
"""Ends the name of a stage that runs while the step's own thread does something else, or waits for it."""


class StageClock:
    """Seconds each module of the tracker took since the last ``lap``, calls to other modules left out."""

    def __init__(self) -> None:
        self._spent: dict[str, float] = defaultdict(float)
        self._thread = threading.local()
        self._main = threading.get_ident()

    def wrap(self, stage: str, function: Callable[..., Any]) -> Callable[..., Any]:
        """The function with its time added to a stage."""

        @functools.wraps(function)
        def timed(*args: Any, **kwargs: Any) -> Any:
            stack = self._thread.__dict__.setdefault("stack", [])
            inner = [0.0]
            stack.append(inner)
            start = time.perf_counter()
            try:
                return function(*args, **kwargs)
            finally:
                whole = time.perf_counter() - start
                stack.pop()
                beside = "" if threading.get_ident() == self._main else BESIDE
                self._spent[stage + beside] += whole - inner[0]
                if stack:
                    stack[-1][0] += whole

        return timed

    def lap(self) -> dict[str, float]:
        """Seconds of each stage, and begin anew."""
        out = dict(self._spent)
        self._spent.clear()
        return out


def _tracker_modules() -> list[ModuleType]:
    for info in pkgutil.iter_modules(teleop.body.__path__):
        importlib.import_module(f"{teleop.body.__name__}.{info.name}")
    return [m for name, m in sys.modules.items() if name.startswith(teleop.body.__name__ + ".")]


@contextmanager
def staged() -> Iterator[StageClock]:
    """While this is open, functions that one module of teleop.body takes from another are timed."""
    clock, changed = StageClock(), []
    prefix = teleop.body.__name__ + "."
    for module in _tracker_modules():
        for name, value in list(vars(module).items()):
            kernel = getattr(value, "py_func", value)
            home = getattr(kernel, "__module__", "")
            if isinstance(kernel, FunctionType) and home.startswith(prefix) and home != module.__name__:
                changed.append((module, name, value))
    try:
        for module, name, value in changed:
            # kernels are called by other kernels too: those calls are compiled and must stay as they are
            if not hasattr(value, "py_func"):
                setattr(module, name, clock.wrap(value.__module__.removeprefix(prefix), value))
        yield clock
    finally:
        for module, name, value in changed:
            setattr(module, name, value)
