"""WS /stream: hello, then states, events and pictures; the client says what it wants and what it has painted."""

from __future__ import annotations

import asyncio
import time

from fastapi import APIRouter, WebSocket, WebSocketDisconnect
from pydantic import TypeAdapter, ValidationError

from server import wire
from server.access.desk import Desk
from server.access.rates import Rates
from server.api.deps import CallerDep, DeskDep, EngineDep, HubDep
from server.engine.engine import Engine
from server.errors import Refused
from server.stream.hub import Client, Hub

router = APIRouter()
_CLIENT_MESSAGE: TypeAdapter[wire.Painted | wire.View] = TypeAdapter(wire.ClientMessage)
_TRY_LATER = 1013
_POLICY = 1008
_CLOSE_S = 2.0
_LONGEST = 1000
"""Characters of a message of a client; the longest legal one has about 50."""


@router.websocket("/stream")
async def stream(
    socket: WebSocket, engine: EngineDep, hub: HubDep, desk: DeskDep, caller: CallerDep, boot: str = "", after: str = ""
) -> None:
    """One task sends, one receives, one watches for a client that does not read; the first to end ends all.

    boot, after: what a client that was cut off saw last (hello.boot, event.id); it is told only what it missed.
    """
    await socket.accept()
    try:
        client = hub.join(caller)
    except Refused as refusal:
        await socket.close(_TRY_LATER, refusal.detail)
        return
    desk.joined(caller)
    _greet(client, engine, hub, desk, int(after) if boot == engine.boot and after.isdecimal() else None)
    rate = desk.config.messages_per_s
    receive = _receive(socket, client, engine, hub, Rates(rate, round(2 * rate)))
    tasks = [asyncio.create_task(work) for work in (_send(socket, client), receive, client.outbox.overflowed.wait())]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        hub.leave(client)
        desk.left(caller)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
    if client.outbox.overflowed.is_set():
        await _close_stalled(socket)


def _greet(client: Client, engine: Engine, hub: Hub, desk: Desk, seen: int | None) -> None:
    events, missed = (hub.history(), 0) if seen is None else hub.after(seen)
    hello = engine.hello().model_copy(update={"missed_events": missed})
    client.outbox.put_event(hello.model_dump_json())
    client.outbox.put_event(desk.access(client.caller).model_dump_json())
    for event in events:
        client.outbox.put_event(event)


async def _close_stalled(socket: WebSocket) -> None:
    """Say why, if the connection still takes it; a client that reads nothing does not hear it."""
    try:
        await asyncio.wait_for(socket.close(_POLICY, "events were not read; connect again"), _CLOSE_S)
    except (TimeoutError, RuntimeError, WebSocketDisconnect):
        return


async def _send(socket: WebSocket, client: Client) -> None:
    try:
        while True:
            payload = await client.outbox.get()
            if isinstance(payload, str):
                await socket.send_text(payload)
            else:
                await socket.send_bytes(payload)
    except (WebSocketDisconnect, RuntimeError):
        return  # gone while we were sending


async def _receive(socket: WebSocket, client: Client, engine: Engine, hub: Hub, rate: Rates) -> None:
    try:
        while True:
            text = await socket.receive_text()
            if len(text) > _LONGEST or rate.wait_s("", time.monotonic()):
                await socket.close(_POLICY, f"messages have at most {_LONGEST} characters, and not so many a second")
                return
            try:
                message = _CLIENT_MESSAGE.validate_json(text)
            except ValidationError as error:
                first = error.errors(include_url=False, include_input=False)[0]
                detail = f"{'.'.join(map(str, first['loc'])) or 'message'}: {first['msg']}; legal types: painted, view"
                client.outbox.put("error", wire.ErrorMessage(detail=detail).model_dump_json())
                continue
            if isinstance(message, wire.Painted):
                engine.publisher.painted(message.seq, message.paint_ms)
            else:
                hub.view(client, message)
    except (WebSocketDisconnect, KeyError):
        return  # closed, or a binary message where only text is legal
