"""WS /push: frames from another machine become the source, for as long as the sender is connected."""

from __future__ import annotations

import asyncio

from fastapi import APIRouter, WebSocket, WebSocketDisconnect

from server import wire
from server.api.deps import EngineDep
from server.engine.engine import Engine
from server.errors import Refused
from teleop.errors import TeleopError
from teleop.sources.push import PushSource
from teleop.sources.push_codec import decode_camera, decode_frame, encode_ack

router = APIRouter()
_POLICY = 1008
NAME = "push:"


@router.websocket("/push")
async def push(socket: WebSocket, engine: EngineDep) -> None:
    """The sender's camera, then its frames (teleop.sources.push_codec); each frame is acknowledged."""
    await socket.accept()
    try:
        await _session(socket, engine)
    except TeleopError as error:
        await socket.send_text(wire.ErrorMessage(detail=str(error)).model_dump_json())
        await socket.close(_POLICY)
    except (WebSocketDisconnect, KeyError):
        return  # the sender is gone, or sent text where bytes are legal


async def _session(socket: WebSocket, engine: Engine) -> None:
    camera, has_color = decode_camera(await socket.receive_text())
    if engine.session is not None:
        raise Refused(409, f"'{engine.session.name}' is running; close its session before frames are pushed")
    source = PushSource(camera, has_color=has_color)
    session = await asyncio.to_thread(engine.open, NAME, source, False)
    try:
        while session.ended is None:
            data = await socket.receive_bytes()
            frame = await asyncio.to_thread(decode_frame, data, camera)
            source.feed(frame)
            await socket.send_text(encode_ack(frame.seq))
    finally:
        source.close()
        await asyncio.to_thread(engine.close_session, session.id)
