"""Who may talk to the server at all: host names, web origins, body sizes. Pure ASGI, so websockets pass here too."""

from __future__ import annotations

from collections.abc import Sequence
from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from server.api.problems import problem
from server.settings import LOOPBACK

_SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})


class Guard:
    """Refuses (403) a foreign web origin on websockets and on methods that change something, and, while the server
    listens on loopback, a foreign host name (DNS rebinding); refuses (413) bodies over the limit."""

    def __init__(
        self, app: ASGIApp, *, loopback_only: bool, allowed_origins: Sequence[str], json_bytes: int, upload_bytes: int
    ) -> None:
        self._app = app
        self._loopback_only = loopback_only
        self._allowed = frozenset(origin.rstrip("/").lower() for origin in allowed_origins)
        self._json_bytes = json_bytes
        self._upload_bytes = upload_bytes

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Check, then pass on."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        if (refused := self._refusal(scope, headers)) is not None:
            code, why = refused
            if scope["type"] == "websocket":
                await receive()
                await send({"type": "websocket.close", "code": 1008, "reason": why[:120]})
            else:
                await problem(403, why, code=code)(scope, receive, send)
            return
        if scope["type"] == "http":
            await self._limited(scope, receive, send, headers)
        else:
            await self._app(scope, receive, send)

    def _refusal(self, scope: Scope, headers: Headers) -> tuple[str, str] | None:
        """Code and words, None when there is nothing against the request."""
        host = headers.get("host", "")
        if self._loopback_only and _name(host) not in LOOPBACK:
            return "host", f"host '{host}' is not this server; use http://127.0.0.1 or start it with --host"
        origin = headers.get("origin")
        changes = scope["type"] == "websocket" or scope["method"] not in _SAFE_METHODS
        if origin is None or not changes:
            return None
        if urlsplit(origin).netloc.lower() == host.lower() or origin.rstrip("/").lower() in self._allowed:
            return None
        return "origin", f"origin '{origin}' may not command this server; name it in allowed_origins if it should"

    async def _limited(self, scope: Scope, receive: Receive, send: Send, headers: Headers) -> None:
        upload = headers.get("content-type", "").startswith("multipart/form-data")
        limit = self._upload_bytes if upload else self._json_bytes
        declared = headers.get("content-length", "0")
        too_large = problem(
            413, f"the body is larger than {limit} bytes; the limit is in the settings under upload", code="size"
        )
        if not declared.isdigit() or int(declared) > limit:
            await too_large(scope, receive, send)
            return
        seen = 0
        exceeded = started = False

        async def counted() -> Message:
            nonlocal seen, exceeded
            message = await receive()
            seen += len(message.get("body", b""))
            if seen > limit:
                exceeded = True
                raise _TooLarge
            return message

        async def watched(message: Message) -> None:
            nonlocal started
            if not exceeded:  # what is answered to a body cut short is not the answer to this request
                started = True
                await send(message)

        try:
            await self._app(scope, counted, watched)
        except _TooLarge:
            exceeded = True
        if exceeded and not started:
            await too_large(scope, receive, send)


class _TooLarge(Exception):
    """The body grew over the limit while it was read (no content-length was given)."""


def _name(host: str) -> str:
    """Host header without the port and without brackets."""
    return (urlsplit(f"//{host}").hostname or "").lower()
