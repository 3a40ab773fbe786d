"""The process a sensor's library lives in: ``python -m teleop.sources.driver_worker KIND ARGUMENT FD``.

A library that crashes, ends the process, hangs, prints, or swells on a damaged file does so here and not where the
robot is controlled.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import resource
import signal
import socket
import sys
from collections.abc import Callable
from typing import Final

from teleop.errors import TeleopError
from teleop.sources.base import Source
from teleop.sources.driver_wire import Kind, info_to_json, receive, send, send_frame

FILE_SUFFIXES: Final = (".oni", ".bag", ".db3")
MEMORY_BYTES: Final = 4 << 30
"""Address space while a file is played: many times what an honest one needs."""
_PR_SET_PDEATHSIG: Final = 1


def openni2(argument: str) -> Source:
    """OpenNI2 device or .oni file."""
    from teleop.sources.openni2 import OpenNI2Source

    return OpenNI2Source(argument)


def freenect(argument: str) -> Source:
    """Kinect v1 through libfreenect."""
    from teleop.sources.freenect import FreenectSource

    return FreenectSource(argument)


def realsense(argument: str) -> Source:
    """RealSense device, .bag or .db3."""
    from teleop.sources.realsense import RealSenseSource

    return RealSenseSource(argument)


def orbbec(argument: str) -> Source:
    """Orbbec device."""
    from teleop.sources.orbbec import OrbbecSource

    return OrbbecSource(argument)


DRIVERS: Final[dict[str, Callable[[str], Source]]] = {
    "openni2": openni2,
    "freenect": freenect,
    "realsense": realsense,
    "orbbec": orbbec,
}


def work(kind: str, argument: str, sock: socket.socket) -> None:
    """Open the source and send its frames once they are asked for, until the owner hangs up."""
    try:
        source = DRIVERS[kind](argument)
    except TeleopError as error:
        send(sock, Kind.ERROR, {"text": str(error)})
        return
    try:
        send(sock, Kind.INFO, info_to_json(source.info))
        asked = receive(sock)
        if asked is not None:
            _run(source, sock, float(asked[1]["from_s"]))
    finally:
        source.close()


def _run(source: Source, sock: socket.socket, from_s: float) -> None:
    try:
        for frame in source.frames(from_s):
            send_frame(sock, frame)
    except TeleopError as error:
        send(sock, Kind.ERROR, {"text": str(error)})
    else:
        send(sock, Kind.END, {})


def main() -> None:
    """Child process."""
    kind, argument, number = sys.argv[1:]
    # an owner that is killed takes its drivers along
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the owner, who closes the sensor in order
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if argument.lower().endswith(FILE_SUFFIXES):
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    with contextlib.suppress(ConnectionError):  # the owner has gone
        work(kind, argument, socket.socket(fileno=int(number)))
    os._exit(0)  # some libraries crash on their way out


if __name__ == "__main__":
    main()
