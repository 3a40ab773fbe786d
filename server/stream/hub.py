"""All clients of the stream: what each wants to see, and one message handed to every outbox."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

from server import wire
from server.errors import Refused
from server.images_wire import ImageKind, ImagePacket
from server.stream.outbox import Outbox, Payload

_IMAGE: dict[str, frozenset[ImageKind]] = {
    "depth": frozenset({ImageKind.DEPTH}),
    "color": frozenset({ImageKind.COLOR}),
    "none": frozenset(),
}


@dataclass(eq=False)
class Client:
    """One connection. ``wanted`` starts with the depth picture, as wire.View does."""

    outbox: Outbox
    wanted: frozenset[ImageKind] = field(default=_IMAGE["depth"])


class Hub:
    """Clients belong to the event loop; the ``post_*`` methods may be called from any thread."""

    def __init__(self, max_clients: int, max_events: int, history: int) -> None:
        self._max_clients = max_clients
        self._max_events = max_events
        self._clients: set[Client] = set()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._wanted: frozenset[ImageKind] = frozenset()
        # half of what an outbox holds, so that a new client is not stalled from the start
        self._history: deque[str] = deque(maxlen=min(history, max_events // 2))

    def bind(self, loop: asyncio.AbstractEventLoop | None) -> None:
        """Name the event loop that the clients live in; None when it is about to close."""
        self._loop = loop

    @property
    def wanted(self) -> frozenset[ImageKind]:
        """Pictures that somebody looks at."""
        return self._wanted

    @property
    def count(self) -> int:
        """Connected clients."""
        return len(self._clients)

    @property
    def history(self) -> tuple[str, ...]:
        """The last events, oldest first, for a client that was not there when they happened."""
        return tuple(self._history)

    def join(self) -> Client:
        """A new client. Raises Refused (503) when there are too many."""
        if len(self._clients) >= self._max_clients:
            raise Refused(503, f"{self._max_clients} clients are connected already; close one of them")
        client = Client(Outbox(self._max_events))
        self._clients.add(client)
        self._look_around()
        return client

    def leave(self, client: Client) -> None:
        """The connection is gone."""
        self._clients.discard(client)
        self._look_around()

    def view(self, client: Client, view: wire.View) -> None:
        """What the client wants to see from now on."""
        client.wanted = _IMAGE[view.image] | (frozenset({ImageKind.HEAD}) if view.head else frozenset())
        self._look_around()

    def post_state(self, text: str) -> None:
        """A state for everybody; replaces the one not yet sent."""
        self._post(lambda: self._each("state", text))

    def post_event(self, text: str, remember: bool = False) -> None:
        """An event (or a new hello) for everybody; never dropped. remember: new clients get it, too."""

        def deliver() -> None:
            if remember:
                self._history.append(text)
            for client in self._clients:
                client.outbox.put_event(text)

        if remember and self._loop is None:
            self._history.append(text)  # nobody is there yet; what happens while the server starts is told later
        self._post(deliver)

    def post_image(self, packet: ImagePacket) -> None:
        """A picture for those who look at its kind."""
        data = packet.to_bytes()

        def deliver() -> None:
            for client in self._clients:
                if packet.kind in client.wanted:
                    client.outbox.put(packet.kind.name, data)

        self._post(deliver)

    def _each(self, kind: str, payload: Payload) -> None:
        for client in self._clients:
            client.outbox.put(kind, payload)

    def _post(self, deliver: Callable[[], None]) -> None:
        loop = self._loop
        if loop is not None and not loop.is_closed():
            loop.call_soon_threadsafe(deliver)

    def _look_around(self) -> None:
        self._wanted = frozenset().union(*(client.wanted for client in self._clients))
