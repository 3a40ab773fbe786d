"""All clients of the stream: what each wants to see, and one message handed to every outbox."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

from server import wire
from server.access.roles import Caller
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
    caller: Caller
    wanted: frozenset[ImageKind] = field(default=_IMAGE["depth"])


class Hub:
    """Clients belong to the event loop; the ``post_*`` methods may be called from any thread."""

    def __init__(self, max_clients: int, max_events: int, history: int) -> None:
        self._max_clients = max_clients
        self._max_events = max_events
        self._clients: set[Client] = set()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._wanted: frozenset[ImageKind] = frozenset()
        self._kept: dict[str, str] = {}
        # half of what an outbox holds, so that a new client is not stalled from the start
        self._history: deque[tuple[int, str]] = deque(maxlen=max_events // 2)
        self._told_first = history
        self._replaced = self._overflowed = 0

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
    def callers(self) -> tuple[Caller, ...]:
        """Who is connected, once for each connection."""
        return tuple(client.caller for client in self._clients)

    @property
    def replaced(self) -> int:
        """Messages that a newer one of their kind replaced before a slow client took them."""
        return self._replaced + sum(client.outbox.replaced for client in self._clients)

    @property
    def overflowed(self) -> int:
        """Clients closed because they left too many events unread."""
        return self._overflowed

    def history(self) -> tuple[str, ...]:
        """The last events, oldest first, for a client that is new."""
        told = list(self._history)[-self._told_first :] if self._told_first else []
        return tuple(text for _, text in told)

    def after(self, event_id: int) -> tuple[tuple[str, ...], int]:
        """The events after one that a client saw, oldest first, and how many of them are no longer held."""
        texts = tuple(text for known, text in self._history if known > event_id)
        first = self._history[0][0] if self._history else event_id + 1
        return texts, max(0, first - event_id - 1)

    def join(self, caller: Caller) -> Client:
        """A new client. Raises Refused (503) when there are too many."""
        if len(self._clients) >= self._max_clients:
            raise Refused(503, f"{self._max_clients} clients are connected already; close one of them")
        client = Client(Outbox(self._max_events), caller)
        for kind, text in self._kept.items():
            client.outbox.put(kind, text)
        self._clients.add(client)
        self._look_around()
        return client

    def leave(self, client: Client) -> None:
        """The connection is gone."""
        if client in self._clients:
            self._replaced += client.outbox.replaced
            self._overflowed += client.outbox.overflowed.is_set()
        self._clients.discard(client)
        self._look_around()

    def view(self, client: Client, view: wire.View) -> None:
        """What the client wants to see from now on."""
        beside = {kind for kind, asked in ((ImageKind.HEAD, view.head), (ImageKind.PARTS, view.parts)) if asked}
        client.wanted = _IMAGE[view.image] | beside
        self._look_around()

    def post_state(self, text: str) -> None:
        """A state for everybody; replaces the one not yet sent."""
        self._post(lambda: self._each("state", text))

    def post_kept(self, kind: str, text: str) -> None:
        """What stays true until a newer message of its kind: for everybody, and for each who joins later."""

        def deliver() -> None:
            self._kept[kind] = text
            self._each(kind, text)

        self._post(deliver)

    def post_event(self, text: str, event_id: int = 0) -> None:
        """An event (or a new hello) for everybody; never dropped. Those with an id are kept for who comes later."""

        def deliver() -> None:
            if event_id:
                self._history.append((event_id, text))
            for client in self._clients:
                client.outbox.put_event(text)

        if event_id and self._loop is None:
            self._history.append((event_id, text))  # what happens while the server starts is told later
        self._post(deliver)

    def tell_each(self, text: Callable[[Caller], str]) -> None:
        """A message of its own for every client; never dropped. For the event loop's thread."""
        for client in self._clients:
            client.outbox.put_event(text(client.caller))

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
