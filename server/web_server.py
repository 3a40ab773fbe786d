"""The web server with what the robot needs of it: a stop at the signal, and a reload."""

from __future__ import annotations

import asyncio
import logging
import signal
import socket
from concurrent.futures import Future
from types import FrameType
from typing import TYPE_CHECKING

import uvicorn

from server.errors import SettingsError
from server.reload import Read, Reloaded, reload

if TYPE_CHECKING:
    from server.engine.engine import Engine

_log = logging.getLogger(__name__)


class StoppingServer(uvicorn.Server):
    """Stops the robot at the signal, not only when the last connection is closed; SIGHUP reads the settings again."""

    def __init__(self, config: uvicorn.Config, engine: Engine, read: Read) -> None:
        super().__init__(config)
        self._engine = engine
        self._read = read
        self._loop: asyncio.AbstractEventLoop | None = None

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        self._loop = asyncio.get_running_loop()
        self._loop.add_signal_handler(signal.SIGHUP, self._reload)
        await super().startup(sockets)

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        if self._loop is not None:
            self._loop.call_soon_threadsafe(self._engine.estop, True)
        super().handle_exit(sig, frame)

    def _reload(self) -> None:
        try:
            future = reload(self._engine, self._read)
        except SettingsError as error:
            _log.error("settings not reloaded, the old ones stay in force: %s", error)
            return
        future.add_done_callback(_say_reloaded)


def _say_reloaded(future: Future[Reloaded]) -> None:
    if (error := future.exception()) is not None:
        _log.error("settings not reloaded, the old ones stay in force: %s", error)
        return
    told = future.result()
    _log.info("settings reloaded", extra={"changed": told.changed})
    if told.needs_restart:
        _log.warning("these settings count from the next start on: %s", ", ".join(told.needs_restart))
