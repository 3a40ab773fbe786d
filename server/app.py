"""The web application: routers, static console, guard."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

from fastapi import APIRouter, FastAPI
from fastapi.responses import HTMLResponse
from starlette.staticfiles import StaticFiles

from server.access.desk import Desk
from server.access.gate import Gate
from server.access.tokens import Tokens
from server.api import (
    access,
    config,
    docs,
    health,
    jobs,
    metrics,
    motions,
    openapi,
    operate,
    operators,
    problems,
    push,
    recording_jobs,
    recordings,
    replay,
    runs,
    sessions,
    stream,
    tasks,
    virtual,
)
from server.api.guard import Guard
from server.engine.engine import Engine
from server.jobs import Jobs
from server.library import Library
from server.loop_lag import LoopLag
from server.reload import Read
from server.settings import Settings
from server.stream.hub import Hub
from teleop.reasons import Reason
from teleop.software import software_version

CONSOLE = Path(__file__).resolve().parent / "console"
_NOT_BUILT = """<!doctype html><html lang="en"><meta charset="utf-8"><title>greenhouse-teleop</title>
<body style="font-family:system-ui;margin:4rem auto;max-width:40rem">
<h1>The console is not built</h1>
<p>Run <code>make setup</code> in the project folder, then reload this page.</p>
<p>The API works already: <a href="/docs">/docs</a>, <a href="/api/v1/state">/api/v1/state</a>.</p></body></html>"""


def create_app(
    engine: Engine, hub: Hub, library: Library, settings: Settings, tokens: Tokens, read: Read | None = None
) -> FastAPI:
    """The application around a running engine. It binds the hub to its event loop; it does not stop the engine.

    read: reads the settings again for a reload; by default they stay what they are.
    """
    desk = Desk(tokens, settings.access, settings.port, engine.publisher.announce, engine.audit)
    jobs_kept = Jobs(files_in=lambda: _beside(library.folder))
    lag = LoopLag()
    measured = metrics.EngineMetrics(engine, hub, desk, jobs_kept, lag)

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        hub.bind(asyncio.get_running_loop())
        desk.changed = lambda: hub.tell_each(lambda caller: desk.access(caller).model_dump_json())
        desk.taken = lambda: _disengage(engine)
        desk.lost = lambda: engine.end_picks(Reason.ASSIST_LEASE)
        watching = [asyncio.create_task(work) for work in (_watch(desk), lag.watch())]
        yield
        for task in watching:
            task.cancel()
        jobs_kept.close()
        hub.bind(None)

    app = FastAPI(
        title="Greenhouse teleoperation",
        version=software_version(),
        summary="Drive a three-arm greenhouse robot with your body in front of a depth camera.",
        lifespan=lifespan,
        generate_unique_id_function=openapi.operation_id,
        docs_url=None,
        redoc_url=None,
    )
    app.state.desk, app.state.jobs, app.state.read = desk, jobs_kept, read or (lambda: settings)
    app.state.engine, app.state.hub, app.state.library = engine, hub, library
    app.state.studies = settings.studies
    problems.install(app)
    api = APIRouter(prefix="/api/v1")
    parts = (
        health,
        access,
        config,
        operators,
        operate,
        tasks,
        runs,
        replay,
        recordings,
        recording_jobs,
        motions,
        sessions,
        jobs,
        stream,
        push,
        virtual,
    )
    for part in parts:
        api.include_router(part.router)
    app.include_router(api)
    app.include_router(metrics.metrics_router(measured))
    openapi.install(app)
    docs.install(app)
    _mount_console(app)
    app.add_middleware(Gate, desk=desk, answer=problems.refusal)
    app.add_middleware(
        Guard,
        loopback_only=not settings.is_public,
        allowed_origins=settings.allowed_origins,
        json_bytes=settings.upload.json_kb * 1000,
        upload_bytes=settings.upload.recording_mb * 1_000_000 + 10_000,
    )
    app.add_middleware(metrics.Requests, counts=measured.requests, seconds=measured.seconds)
    return app


def _beside(library: Path) -> Path:
    """Where jobs keep their files: on the disk of the recordings, whatever room the system's own folder has."""
    library.parent.mkdir(parents=True, exist_ok=True)
    return library.parent


def _disengage(engine: Engine) -> None:
    engine.engage(False)


async def _watch(desk: Desk) -> None:
    while True:
        await asyncio.sleep(1.0)
        desk.watch()


def _mount_console(app: FastAPI) -> None:
    if (CONSOLE / "index.html").is_file():
        app.mount("/", StaticFiles(directory=CONSOLE, html=True), name="console")
        return

    @app.get("/", include_in_schema=False)
    def not_built() -> HTMLResponse:
        return HTMLResponse(_NOT_BUILT, status_code=503)
