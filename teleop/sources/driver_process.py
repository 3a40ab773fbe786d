"""A sensor driver in a process of its own, seen from here as any other source.

What the library does to its process is a SourceError here: a crash, an exit, a hang, memory without end.
"""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Iterator
from contextlib import suppress
from typing import IO, Any, Final

from teleop.errors import SourceError
from teleop.frames import DepthFrame
from teleop.sources.base import SourceInfo
from teleop.sources.driver_wire import Kind, frame_of, info_from_json, receive, send

OPEN_S: Final = 30.0
"""Longest wait for a library to open its device; a RealSense that resets takes some seconds."""
LIVE_SILENCE_S: Final = 10.0
FILE_SILENCE_S: Final = 30.0
"""Drivers themselves report a silent device after 2 to 5 s: beyond this the library hangs."""
CLOSE_S: Final = 3.0
_BUFFER_BYTES: Final = 4 << 20


class DriverProcess:
    """One device or file. ``close`` may be called from any thread and ends ``frames``."""

    def __init__(self, kind: str, argument: str = "") -> None:
        """Start the driver and open its device. Raises SourceError."""
        self._kind = kind
        self._argument = argument
        self._name = f"{kind}:{argument}"
        self._closed = False
        self._used = False
        self._switching = threading.Lock()
        self._last_words: deque[str] = deque(maxlen=5)
        self._start()

    @property
    def info(self) -> SourceInfo:
        """What the driver knows of the device or file."""
        return self._info

    @property
    def process_id(self) -> int:
        """Of the driver's process."""
        return self._child.pid

    def frames(self, from_s: float = 0.0) -> Iterator[DepthFrame]:
        """Frames as the driver gives them. Raises SourceError when the device or its library fails."""
        if self._used:  # a new process: libOpenNI2 2.2 crashes on what it has opened three times
            self._end()
            self._start()
        self._used = True
        self._sock.settimeout(LIVE_SILENCE_S if self._info.live else FILE_SILENCE_S)
        process_id = self.process_id
        try:
            send(self._sock, Kind.RUN, {"from_s": from_s})
        except OSError:
            raise self._died() from None
        while process_id == self.process_id:
            message = self._message()
            if message is None:
                return
            kind, content, data = message
            if kind is Kind.END:
                return
            if kind is Kind.ERROR:
                raise SourceError(str(content["text"]))
            yield frame_of(content, data, self._info.camera)

    def close(self) -> None:
        """Let the driver close its device, and end its process; safe to call twice."""
        self._closed = True
        self._end()

    def _start(self) -> None:
        self._sock, theirs = socket.socketpair()
        for end in (self._sock, theirs):
            end.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _BUFFER_BYTES)
        worker = "teleop.sources.driver_worker"
        command = [sys.executable, "-m", worker, self._kind, self._argument, str(theirs.fileno())]
        self._child = subprocess.Popen(
            command,
            pass_fds=(theirs.fileno(),),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,  # libraries greet their users there
            stderr=subprocess.PIPE,
            env=os.environ | {"OPENBLAS_NUM_THREADS": "1"},
        )
        theirs.close()
        assert self._child.stderr is not None
        threading.Thread(target=self._listen, args=(self._child.stderr,), daemon=True).start()
        try:
            self._info = self._opened()
        except BaseException:
            self._end()
            raise

    def _end(self) -> None:
        with suppress(OSError):  # the driver may have gone before
            self._sock.shutdown(socket.SHUT_RDWR)
        with self._switching:
            try:
                self._child.wait(CLOSE_S)
            except subprocess.TimeoutExpired:
                self._child.kill()
                self._child.wait()
            self._sock.close()

    def _opened(self) -> SourceInfo:
        self._sock.settimeout(OPEN_S)
        message = self._message()
        if message is None:
            raise SourceError(f"{self._name} was closed while it opened")
        kind, content, _ = message
        if kind is Kind.ERROR:
            raise SourceError(str(content["text"]))
        return info_from_json(content)

    def _message(self) -> tuple[Kind, dict[str, Any], bytearray] | None:
        """The next one, None once this source is closed. Raises SourceError."""
        try:
            message = receive(self._sock)
        except TimeoutError:
            if self._closed:
                return None
            self._child.kill()
            wait_s = self._sock.gettimeout()
            raise SourceError(f"{self._name}: its library did not answer for {wait_s:.0f} s and was ended") from None
        except OSError:
            message = None
        if message is None and not self._closed:
            raise self._died()
        return None if self._closed else message

    def _died(self) -> SourceError:
        """Why the process is gone, in one line."""
        try:
            code = self._child.wait(CLOSE_S)
        except subprocess.TimeoutExpired:
            self._child.kill()
            code = self._child.wait()
        if code < 0:
            how = f"crashed ({signal.Signals(-code).name})"
        else:
            how = f"ended its process (exit code {code})"
        words = f": {self._last_words[-1]}" if self._last_words else ""
        step = "the file may be damaged" if "." in self._name else "run 'teleop doctor'"
        return SourceError(f"{self._name}: the sensor's library {how}{words}; {step}")

    def _listen(self, stream: IO[bytes]) -> None:
        with stream:
            for line in stream:
                text = " ".join(line.decode(errors="replace").split())
                if text:
                    self._last_words.append(text[:200])
