"""The work behind ``teleop push``: a source's frames over a websocket, paced, with a few on the way at most."""

from __future__ import annotations

import ssl
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from urllib.parse import urlsplit

from websockets.exceptions import ConnectionClosed, InvalidHandshake, InvalidStatus, InvalidURI
from websockets.sync.client import ClientConnection, connect

from teleop.errors import SourceError
from teleop.frames import DepthFrame
from teleop.sources.base import Source
from teleop.sources.push_codec import PushWindow, decode_ack, encode_camera, encode_frame

RETRY_S = 0.5
_STATUS = {4401: 401, 4403: 403}
"""Codes with which the server hangs up on who may not push, and what they would be over HTTP."""
GIVE_UP_S = 30.0
"""A server that restarts is back by then; a wrong address is told at once."""


@dataclass(frozen=True, slots=True)
class PushOptions:
    """seconds: how long. color: whether it is sent. loop: again at the end. window: frames on the way at most.
    lost_s: an answer that takes longer counts as lost. token: of a role that may command, needed from another machine.
    ca: certificate (PEM) that the server's is signed by, where the system does not know it."""

    seconds: float | None = None
    color: bool = True
    loop: bool = False
    window: int = 8
    lost_s: float = 1.0
    token: str | None = None
    ca: Path | None = None


@dataclass(slots=True)
class Sent:
    """Counts since the start."""

    sent: int = 0
    dropped: int = 0
    connections: int = 0


def push_frames(
    source: Source, url: str, options: PushOptions, on_frame: Callable[[DepthFrame], None] | None = None
) -> Sent:
    """Send until the source ends, the time is up or Ctrl-C.

    Raises SourceError: a wrong address, a server that refuses, one that stays away.
    """
    _check(url)
    count = Sent()
    frames = paced(source, options)
    line = _Line(source, url, options, count)
    try:
        line.open(patient=False)
        for frame in frames:
            while not line.send(frame):
                line.open(patient=True)
            if on_frame is not None:
                on_frame(frame)
        line.finish()
    except KeyboardInterrupt:
        return count
    finally:
        line.close()
    return count


class _Line:
    """One connection at a time."""

    def __init__(self, source: Source, url: str, options: PushOptions, count: Sent) -> None:
        self._source = source
        self._url = url
        self._options = options
        self._count = count
        self._hold = ExitStack()
        self._socket: ClientConnection | None = None
        self._window = PushWindow(options.window, options.lost_s)
        self._answered = False
        self._until_s = 0.0
        self._headers = {"Authorization": f"Bearer {options.token}"} if options.token else {}
        self._tls = None if options.ca is None else _trusting(options.ca)

    def open(self, *, patient: bool) -> None:
        """Connect and announce the camera; a patient one tries again for a while. Raises SourceError."""
        if self._answered or not patient:
            self._until_s = time.monotonic() + GIVE_UP_S
        while True:
            try:
                opened = connect(
                    self._url, open_timeout=5, max_size=1 << 20, additional_headers=self._headers, ssl=self._tls
                )
                self._socket = self._hold.enter_context(opened)
                info = self._source.info
                self._socket.send(encode_camera(info.camera, has_color=info.has_color and self._options.color))
            except InvalidStatus as error:
                self.close()
                raise SourceError(_refused(self._url, error.response.status_code, self._options)) from None
            except (OSError, TimeoutError, InvalidHandshake, InvalidURI, ConnectionClosed) as error:
                self.close()
                self._raise_if_turned_away(error)
                if not patient or time.monotonic() > self._until_s:
                    why = str(error) or type(error).__name__
                    raise SourceError(
                        f"no connection to {self._url}: {why}; is 'teleop serve' running there?"
                    ) from None
                time.sleep(RETRY_S)
                continue
            self._window = PushWindow(self._options.window, self._options.lost_s)
            self._answered = False
            self._count.connections += 1
            return

    def send(self, frame: DepthFrame) -> bool:
        """Send it, or leave it out while too many are on the way. False when the connection is lost."""
        if self._socket is None:
            return False
        try:
            self._take_answers(self._socket, 0.0)
            if not self._window.may_send(frame.seq, time.monotonic()):
                self._count.dropped += 1
                return True
            self._socket.send(encode_frame(frame))
            self._count.sent += 1
        except ConnectionClosed as closed:
            self.close()
            self._raise_if_turned_away(closed)
            return False
        except SourceError:
            # after a break the server may for a while believe that the connection before is still there
            if self._answered or self._count.connections == 1 or time.monotonic() > self._until_s:
                raise
            self.close()
            time.sleep(RETRY_S)
            return False
        return True

    def _raise_if_turned_away(self, error: Exception) -> None:
        """Raises SourceError for a server that hung up because of who we are; trying again would not help."""
        closed = error.rcvd if isinstance(error, ConnectionClosed) else None
        if closed is not None and closed.code in _STATUS:
            raise SourceError(_refused(self._url, _STATUS[closed.code], self._options)) from None

    def finish(self) -> None:
        """Wait a moment for the last answers, so that the server has taken the last frame."""
        try:
            while self._socket is not None and self._window.on_the_way:
                if not self._take_answers(self._socket, 1.0):
                    return
        except ConnectionClosed:
            return

    def close(self) -> None:
        """Hang up; safe to call twice."""
        self._socket = None
        self._hold.close()

    def _take_answers(self, socket: ClientConnection, wait_s: float) -> int:
        """Take what has been answered, waiting for the first answer only. Raises SourceError when refused."""
        taken = 0
        while True:
            try:
                text = socket.recv(timeout=wait_s if not taken else 0.0)
            except TimeoutError:
                return taken
            self._window.acknowledged(decode_ack(str(text)))
            self._answered = True
            taken += 1


def paced(source: Source, options: PushOptions) -> Iterator[DepthFrame]:
    """Frames with one running number and one run of time; recorded ones at the pace of their stamps."""
    seq = 0
    offset_ns = last_ns = 0
    begin_s = time.monotonic()
    origin_ns: int | None = None
    while True:
        again = False
        for frame in source.frames():
            if origin_ns is None:
                origin_ns = frame.t_ns
            if again is False and seq and not source.info.live:
                offset_ns = last_ns + 33_333_333 - frame.t_ns
            again = True
            t_ns = last_ns = frame.t_ns + offset_ns
            passed_s = (t_ns - origin_ns) * 1e-9
            if options.seconds is not None and passed_s > options.seconds:
                return
            if not source.info.live:
                time.sleep(max(0.0, begin_s + passed_s - time.monotonic()))
            kept = frame if options.color else frame.without_color()
            yield replace(kept, t_ns=t_ns, seq=seq)
            seq += 1
        if source.info.live or not options.loop or not again:
            return


def _trusting(ca: Path) -> ssl.SSLContext:
    """Raises SourceError when the file is no certificate."""
    try:
        return ssl.create_default_context(cafile=ca)
    except (ssl.SSLError, OSError) as error:
        raise SourceError(f"{ca} cannot be used as a certificate: {error}; --ca takes a PEM file") from None


def _refused(url: str, status: int, options: PushOptions) -> str:
    """What to do about a server that answers, but not as wanted."""
    if status in (401, 403) and options.token is None:
        return f"{url} wants a token; give one of an operator with --token or TELEOP_TOKEN"
    if status in (401, 403):
        return f"{url} does not take this token; give one of an operator, as 'teleop serve' showed at its first start"
    return f"{url} answers {status}; the address of a server ends with /api/v1/push"


def _check(url: str) -> None:
    parts = urlsplit(url)
    if parts.scheme not in ("ws", "wss") or not parts.hostname:
        raise SourceError(f"'{url}' is no websocket address; give one such as wss://192.168.1.20:8000/api/v1/push")
