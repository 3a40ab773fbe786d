"""Keeps a C library's greetings off the user's terminal."""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def quiet_stdout() -> Iterator[None]:
    """Send what is written to file descriptor 1 (PyBullet's build time and arguments) nowhere for a while.

    Python's own output through sys.stdout in that time is lost too.
    """
    sys.stdout.flush()
    kept = os.dup(1)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 1)
        yield
    finally:
        ctypes.CDLL(None).fflush(None)  # C keeps its output back while it goes to a file
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)
