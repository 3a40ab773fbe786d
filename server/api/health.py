"""GET /health, GET /ready, GET /state."""

from __future__ import annotations

import shutil
from typing import Literal

from fastapi import APIRouter, Response
from pydantic import BaseModel, Field

from server import wire
from server.api.deps import EngineDep
from server.api.models import Health
from server.api.problems import documented
from server.engine.engine import Engine
from server.errors import Refused
from teleop.software import software_version

router = APIRouter(tags=["operation"])


class Ready(BaseModel):
    """Whether an operator could begin now, and what each part says."""

    ready: bool
    checks: dict[Literal["engine", "source", "recording", "disk"], str] = Field(
        description="ok, or what is wrong", examples=[{"engine": "ok", "source": "no source is open"}]
    )


@router.get("/health", responses=documented(503))
def read_health(engine: EngineDep) -> Health:
    """Liveness: 200 while the engine runs, 503 when it has stopped; degraded while its last step is too old."""
    if not engine.is_alive():
        raise Refused(503, "the engine has stopped; see the server's log and restart it")
    session = engine.session
    return Health(
        status="degraded" if _late(engine) else "ok",
        step_age_s=round(engine.step_age_s, 3),
        version=software_version(),
        source=session.name if session else None,
        fault=session.fault if session else None,
    )


@router.get("/ready", responses={503: {"model": Ready, "description": "not ready; the checks say why"}})
def read_ready(engine: EngineDep, response: Response) -> Ready:
    """Readiness: 200 when the engine steps, the source gives frames and a recording could be written, else 503."""
    session, config = engine.session, engine.settings
    fault = "no source is open" if session is None else session.fault
    lost = session is not None and session.recorder is not None and session.recorder.error
    free_mb = _free_mb(engine)
    answer = Ready(
        ready=True,
        checks={
            "engine": "stopped" if not engine.is_alive() else "late" if _late(engine) else "ok",
            "source": fault or "ok",
            "recording": lost or "ok",
            "disk": "ok" if free_mb >= config.engine.min_disk_mb else f"only {free_mb} MB left for recordings",
        },
    )
    if all(said == "ok" for said in answer.checks.values()):
        return answer
    response.status_code = 503
    return answer.model_copy(update={"ready": False})


@router.get("/state", responses=documented(503))
def read_state(engine: EngineDep) -> wire.State:
    """The same state as on the stream, at this moment."""
    latest = engine.publisher.latest()
    if latest is None:
        raise Refused(503, "the engine has not made its first step yet; ask again")
    return latest


def _late(engine: Engine) -> bool:
    return engine.step_age_s > engine.settings.engine.degraded_s


def _free_mb(engine: Engine) -> int:
    folder = engine.settings.library
    while not folder.exists() and folder != folder.parent:
        folder = folder.parent  # made with the first recording
    return shutil.disk_usage(folder).free // 1_000_000
