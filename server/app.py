"""The web application: routers, static console, guard."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

from fastapi import APIRouter, FastAPI
from fastapi.responses import HTMLResponse
from starlette.staticfiles import StaticFiles

from server.api import config, health, motions, operate, problems, push, recordings, replay, sessions, stream
from server.api.guard import Guard
from server.engine.engine import Engine
from server.library import Library
from server.settings import Settings
from server.stream.hub import Hub
from teleop.recording.writer import software_version

CONSOLE = Path(__file__).resolve().parent / "console"
_NOT_BUILT = """<!doctype html><html lang="en"><meta charset="utf-8"><title>greenhouse-teleop</title>
<body style="font-family:system-ui;margin:4rem auto;max-width:40rem">
<h1>The console is not built</h1>
<p>Run <code>make setup</code> in the project folder, then reload this page.</p>
<p>The API works already: <a href="/docs">/docs</a>, <a href="/api/v1/state">/api/v1/state</a>.</p></body></html>"""


def create_app(engine: Engine, hub: Hub, library: Library, settings: Settings) -> FastAPI:
    """The application around a running engine. It binds the hub to its event loop; it does not stop the engine."""

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        hub.bind(asyncio.get_running_loop())
        yield
        hub.bind(None)

    app = FastAPI(
        title="Greenhouse teleoperation",
        version=software_version(),
        summary="Drive a three-arm greenhouse robot with your body in front of a depth camera.",
        lifespan=lifespan,
    )
    app.state.engine, app.state.hub, app.state.library = engine, hub, library
    app.state.studies = settings.studies
    problems.install(app)
    api = APIRouter(prefix="/api/v1")
    for part in (health, config, operate, replay, recordings, motions, sessions, stream, push):
        api.include_router(part.router)
    app.include_router(api)
    app.include_router(health.metrics_router(engine, hub))
    _mount_console(app)
    app.add_middleware(
        Guard,
        loopback_only=not settings.is_public,
        allowed_origins=settings.allowed_origins,
        json_bytes=settings.upload.json_kb * 1000,
        upload_bytes=settings.upload.recording_mb * 1_000_000 + 10_000,
    )
    return app


def _mount_console(app: FastAPI) -> None:
    if (CONSOLE / "index.html").is_file():
        app.mount("/", StaticFiles(directory=CONSOLE, html=True), name="console")
        return

    @app.get("/", include_in_schema=False)
    def not_built() -> HTMLResponse:
        return HTMLResponse(_NOT_BUILT, status_code=503)
