"""Keeps a C library's greetings off the user's terminal."""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

_OUT, _ERROR = 1, 2


@contextmanager
def quiet_output() -> Iterator[None]:
    """Send what is written to standard output and error (PyBullet's build time and arguments) nowhere for a while.

    An exception passes through and is reported by whoever catches it outside.
    """
    sys.stdout.flush()
    sys.stderr.flush()
    kept = {fd: os.dup(fd) for fd in (_OUT, _ERROR)}
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        for fd in kept:
            os.dup2(nowhere, fd)
        yield
    finally:
        ctypes.CDLL(None).fflush(None)  # C keeps its output back while it goes to a file
        for fd, copy in kept.items():
            os.dup2(copy, fd)
            os.close(copy)
        os.close(nowhere)
