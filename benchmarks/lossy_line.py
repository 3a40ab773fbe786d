"""A websocket line between a sender and a server that delays every message and loses some, for the push bench."""

from __future__ import annotations

import random
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect
from websockets.sync.server import ServerConnection, serve


class _Lane(threading.Thread):
    """One direction: in order, each message ``0..jitter_s`` late, binary ones and answers lost with ``loss``."""

    def __init__(
        self,
        take: Callable[[], str | bytes],
        give: Callable[[str | bytes], None],
        jitter_s: float,
        loss: float,
        seed: int,
    ) -> None:
        super().__init__(daemon=True)
        self._take, self._give = take, give
        self._jitter_s, self._loss = jitter_s, loss
        self._chance = random.Random(seed)
        self._queue: deque[tuple[float, str | bytes]] = deque()
        self._ready = threading.Condition()
        self._over = False
        self.lost = 0
        self.passed = 0

    def run(self) -> None:
        sender = threading.Thread(target=self._deliver, daemon=True)
        sender.start()
        first = True
        try:
            while True:
                message = self._take()
                if not first and self._chance.random() < self._loss:  # the opening announces the camera
                    self.lost += 1
                    continue
                first = False
                with self._ready:
                    self._queue.append((time.monotonic() + self._chance.uniform(0.0, self._jitter_s), message))
                    self._ready.notify()
        except ConnectionClosed:
            with self._ready:
                self._over = True
                self._ready.notify()
        sender.join(5.0)

    def _deliver(self) -> None:
        try:
            while True:
                with self._ready:
                    self._ready.wait_for(lambda: self._queue or self._over)
                    if not self._queue:
                        return
                    due_s, message = self._queue.popleft()
                time.sleep(max(0.0, due_s - time.monotonic()))
                self._give(message)
                self.passed += 1
        except ConnectionClosed:
            return


class Counts:
    """What the line did, after it was closed."""

    lost_frames = 0
    lost_answers = 0


@contextmanager
def lossy_line(target: str, jitter_s: float, loss: float, seed: int = 0) -> Iterator[tuple[str, Counts]]:
    """Give the address to push to, and what was lost on the way."""
    counts = Counts()

    def carry(near: ServerConnection) -> None:
        far: ClientConnection
        with connect(target, max_size=1 << 24) as far:
            there = _Lane(near.recv, far.send, jitter_s, loss, seed)
            back = _Lane(far.recv, near.send, jitter_s, loss, seed + 1)
            there.start()
            back.start()
            there.join()
            far.close()
            back.join()
            counts.lost_frames += there.lost
            counts.lost_answers += back.lost

    with serve(carry, "127.0.0.1", 0, max_size=1 << 24) as listening:
        thread = threading.Thread(target=listening.serve_forever, daemon=True)
        thread.start()
        try:
            yield f"ws://127.0.0.1:{listening.socket.getsockname()[1]}/", counts
        finally:
            listening.shutdown()
            thread.join(10)
