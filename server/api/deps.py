"""What the routes need: the engine, the hub and the library of this application, and how to wait for the engine."""

from __future__ import annotations

import asyncio
from concurrent.futures import Future
from typing import Annotated, TypeVar

from fastapi import Depends
from starlette.requests import HTTPConnection

from server.access.desk import Desk
from server.access.roles import Caller
from server.engine.engine import CALL_TIMEOUT_S, Engine
from server.errors import Refused
from server.jobs import Jobs
from server.library import Library
from server.reload import Read
from server.stream.hub import Hub

T = TypeVar("T")


def _engine(connection: HTTPConnection) -> Engine:
    engine: Engine = connection.app.state.engine
    return engine


def _hub(connection: HTTPConnection) -> Hub:
    hub: Hub = connection.app.state.hub
    return hub


def _library(connection: HTTPConnection) -> Library:
    library: Library = connection.app.state.library
    return library


def _read(connection: HTTPConnection) -> Read:
    read: Read = connection.app.state.read
    return read


def _jobs(connection: HTTPConnection) -> Jobs:
    jobs: Jobs = connection.app.state.jobs
    return jobs


def _desk(connection: HTTPConnection) -> Desk:
    desk: Desk = connection.app.state.desk
    return desk


def _caller(connection: HTTPConnection) -> Caller | None:
    caller: Caller | None = connection.scope["state"]["caller"]
    return caller


def _known_caller(connection: HTTPConnection) -> Caller:
    caller = _caller(connection)
    if caller is None:
        raise Refused(401, "a token is needed; send it as 'Authorization: Bearer TOKEN', or log in", "token")
    return caller


EngineDep = Annotated[Engine, Depends(_engine)]
HubDep = Annotated[Hub, Depends(_hub)]
LibraryDep = Annotated[Library, Depends(_library)]
ReadDep = Annotated[Read, Depends(_read)]
JobsDep = Annotated[Jobs, Depends(_jobs)]
DeskDep = Annotated[Desk, Depends(_desk)]
OptionalCallerDep = Annotated[Caller | None, Depends(_caller)]
CallerDep = Annotated[Caller, Depends(_known_caller)]


async def done(future: Future[T]) -> T:
    """Wait for the engine without blocking the event loop. Raises Refused (503) when it does not answer."""
    try:
        return await asyncio.wait_for(asyncio.wrap_future(future), CALL_TIMEOUT_S)
    except TimeoutError:
        raise Refused(503, "the engine does not answer; see the server's log and restart it") from None
