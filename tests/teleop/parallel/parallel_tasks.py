"""Tasks for pools; in a module of their own, because workers import them."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path

from teleop.errors import SourceError


def square(n: int) -> int:
    return n * n


def where(_: int) -> int:
    return os.getpid()


def troubled(n: int) -> int:
    """2 is a user's error, 3 a bug, 4 kills its process."""
    if n == 2:
        raise SourceError("no camera 2")
    if n == 3:
        raise ZeroDivisionError("three")
    if n == 4:
        os.kill(os.getpid(), signal.SIGKILL)
    return n


def wait_for(path: str) -> int:
    """Says its process id in ``path`` and then works for a minute."""
    Path(path).write_text(str(os.getpid()))
    time.sleep(60.0)
    return 0


def late_first(n: int) -> int:
    time.sleep(0.3 if n == 0 else 0.0)
    return n


def version_of_process() -> str:
    return f"process {os.getpid()}"


def version_one() -> str:
    return "1"
