"""What both clients know of their server: addresses, who they are, where a stream that was cut off goes on."""

from __future__ import annotations

import os
import secrets
import ssl
from dataclasses import dataclass, field
from typing import Any
from urllib.parse import quote, urlencode

from pydantic import TypeAdapter
from websockets.exceptions import ConnectionClosed

from server import wire
from server.errors import Refused, ServerError

StreamMessage = (
    wire.Hello | wire.Access | wire.State | wire.EventMessage | wire.Coverage | wire.TaskPreview | wire.ErrorMessage
)
_MESSAGE: TypeAdapter[Any] = TypeAdapter(wire.ServerMessage)
NO_PICTURES = wire.View(image="none").model_dump_json()
FIRST_RETRY_S, LONGEST_RETRY_S = 0.25, 3.0
_REFUSED = {4401: 401, 4403: 403, 4423: 423, 4429: 429, 1008: 429}


@dataclass
class Link:
    """One server and one client of it. token: of a role; by default $TELEOP_TOKEN, and none on the same machine.

    key: the client's secret, by which it holds the lease; name: what others see.
    """

    url: str
    token: str | None = None
    name: str = "python"
    key: str = field(default_factory=lambda: secrets.token_urlsafe(18))
    boot: str = ""
    last_event: int = 0

    def __post_init__(self) -> None:
        self.url = self.url.rstrip("/")
        self.token = self.token or os.environ.get("TELEOP_TOKEN") or None

    @property
    def api(self) -> str:
        """Where the routes are."""
        return f"{self.url}/api/v1"

    @property
    def headers(self) -> dict[str, str]:
        """Who sends."""
        token = {"Authorization": f"Bearer {self.token}"} if self.token else {}
        return {"X-Teleop-Client": self.key, "X-Teleop-Name": quote(self.name), **token}

    @property
    def stream_url(self) -> str:
        """The websocket; after a break it names what was seen last."""
        seen = {"boot": self.boot, "after": str(self.last_event)} if self.boot else {}
        return f"{self.api.replace('http', 'ws', 1)}/stream?{urlencode(seen)}"

    def tls(self, verify: ssl.SSLContext | bool) -> ssl.SSLContext | None:
        """For the websocket, as httpx reads ``verify``; None over plain HTTP."""
        if not self.url.startswith("https"):
            return None
        if isinstance(verify, ssl.SSLContext):
            return verify
        context = ssl.create_default_context()
        if not verify:
            context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
        return context

    def read(self, text: str) -> StreamMessage:
        """A text message of the stream; remembers where the stream is."""
        message: StreamMessage = _MESSAGE.validate_json(text)
        if isinstance(message, wire.Hello):
            if message.boot != self.boot:
                self.last_event = 0
            self.boot = message.boot
        elif isinstance(message, wire.EventMessage):
            self.last_event = message.id
        return message

    def ended(self, closed: ConnectionClosed) -> None:
        """Raises Refused when the server closed the stream because it will not have this client."""
        if closed.rcvd is not None and closed.rcvd.code in _REFUSED:
            raise Refused(_REFUSED[closed.rcvd.code], closed.rcvd.reason)

    def absent(self, error: Exception) -> ServerError:
        """Nobody answers."""
        return ServerError(f"no answer from {self.url} ({error}); start it with 'teleop serve'")
