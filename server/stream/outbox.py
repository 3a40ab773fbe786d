"""One client's send queue: a newer message of the same kind replaces the older one, events are never dropped."""

from __future__ import annotations

import asyncio
from collections import deque

Payload = str | bytes


class Outbox:
    """Belongs to the event loop's thread. Events first, then the newest of every other kind, oldest kind first."""

    def __init__(self, max_events: int) -> None:
        self._events: deque[Payload] = deque()
        self._latest: dict[str, Payload] = {}
        self._ready = asyncio.Event()
        self._max_events = max_events
        self.overflowed = asyncio.Event()
        """Set when the client leaves too many events unread and must be closed."""
        self.replaced = 0

    def put(self, kind: str, payload: Payload) -> None:
        """Leave a message of which only the newest matters."""
        if self._latest.pop(kind, None) is not None:
            self.replaced += 1
        self._latest[kind] = payload
        self._ready.set()

    def put_event(self, payload: Payload) -> None:
        """Leave a message that must arrive."""
        if len(self._events) >= self._max_events:
            self.overflowed.set()
            return
        self._events.append(payload)
        self._ready.set()

    async def get(self) -> Payload:
        """The next message to send."""
        while True:
            if self._events:
                return self._events.popleft()
            if self._latest:
                kind = next(iter(self._latest))
                return self._latest.pop(kind)
            self._ready.clear()
            await self._ready.wait()
