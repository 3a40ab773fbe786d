"""Asks the desk about every request before anything reads its body. Pure ASGI, so websockets pass here too."""

from __future__ import annotations

from collections.abc import Callable

from starlette.responses import Response
from starlette.types import ASGIApp, Receive, Scope, Send

from server.access.desk import Desk
from server.access.policy import API, SAFE_METHODS, need
from server.errors import Refused

_CLOSE_CODES = {401: 4401, 403: 4403, 423: 4423, 429: 4429}
"""Websocket close codes: a page can read these, but not the status of a refused handshake."""


class Gate:
    """Puts the caller into the scope's state, or refuses. answer: turns a refusal into a response."""

    def __init__(self, app: ASGIApp, *, desk: Desk, answer: Callable[[Refused], Response]) -> None:
        self._app = app
        self._desk = desk
        self._answer = answer

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Ask, then pass on."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        method = scope["method"] if scope["type"] == "http" else "WS"
        needs = need(method, scope["path"])
        try:
            caller = None if needs.role is None and not scope["path"].startswith(API) else self._desk.caller(scope)
            self._desk.admit(caller, needs, _action(method, scope["path"]))
        except Refused as refused:
            self._desk.refused[refused.status] += 1
            if scope["type"] == "http":
                await self._answer(refused)(scope, receive, send)
                return
            await receive()
            await send({"type": "websocket.accept"})
            code = _CLOSE_CODES.get(refused.status, 1008)
            await send({"type": "websocket.close", "code": code, "reason": refused.detail[:120]})
            return
        scope.setdefault("state", {})["caller"] = caller
        await self._app(scope, receive, send)


def _action(method: str, path: str) -> str:
    """``POST /api/v1/robot/command`` -> ``robot.command``; other methods are named at the end."""
    words = [word for word in path.removeprefix(API).split("/") if word]
    return ".".join([*words, *([method.lower()] if method not in ("POST", *SAFE_METHODS) else [])])[:80]
