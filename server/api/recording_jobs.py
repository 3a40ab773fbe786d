"""Long jobs over a recording: export it, track it anew, do it again, do it with other settings."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Literal

from fastapi import APIRouter, Response
from pydantic import BaseModel, ConfigDict, Field

from server import recording_work
from server.api.deps import EngineDep, JobsDep, LibraryDep
from server.api.problems import documented
from server.engine.engine import Engine
from server.errors import Refused
from server.job_process import in_process
from server.jobs import Job, JobProgress, Jobs
from server.library import Entry, Library
from server.settings import changed

router = APIRouter(prefix="/recordings/{recording_id}", tags=["recordings"], responses=documented(404, 409, 503))


class ExportAsk(BaseModel):
    """Into what."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"examples": [{"format": "csv"}]})
    format: Literal["csv", "mp4", "lerobot", "fakenect"] = Field(
        description="csv: a table; mp4: a film with the skeleton; lerobot, fakenect: a folder, packed as a zip file"
    )


class WhatIfAsk(BaseModel):
    """Under which other settings."""

    model_config = ConfigDict(
        extra="forbid",
        json_schema_extra={"examples": [{"settings": {"teleop": {"intent": {"mapping": {"mapping": "direction"}}}}}]},
    )
    settings: dict[str, Any] = Field(description="a partial tree, laid over the recorded settings")


@router.post("/export", status_code=202, responses=documented(422))
def export_recording(
    engine: EngineDep, library: LibraryDep, jobs: JobsDep, recording_id: str, ask: ExportAsk, response: Response
) -> Job:
    """Begin to export; the file is at GET /jobs/{id}/file when the job is done."""
    entry = _whole(engine, library, recording_id)
    config = engine.settings.teleop

    def work(progress: JobProgress) -> Mapping[str, Any]:
        output = progress.folder / f"{entry.id}.{ask.format}"
        return in_process(recording_work.export, (entry.path, output, config), progress)

    return _begun(jobs, f"export {ask.format}", work, entry, response)


@router.post("/track", status_code=202)
def track_recording(
    engine: EngineDep, library: LibraryDep, jobs: JobsDep, recording_id: str, response: Response
) -> Job:
    """Begin to track it anew under the present settings, the operator taken as engaged; one row a frame."""
    entry = _whole(engine, library, recording_id)
    config = engine.settings.teleop

    def work(progress: JobProgress) -> Mapping[str, Any]:
        output = progress.folder / f"{entry.id}.jsonl"
        return in_process(recording_work.track, (entry.path, output, config), progress)

    return _begun(jobs, "track", work, entry, response)


@router.post("/verify", status_code=202)
def verify_recording(
    engine: EngineDep, library: LibraryDep, jobs: JobsDep, recording_id: str, response: Response
) -> Job:
    """Begin to do the session again, as recorded, and hold every answer against the recorded one."""
    entry = _whole(engine, library, recording_id)

    def work(progress: JobProgress) -> Mapping[str, Any]:
        return in_process(recording_work.again, (entry.path, None), progress)

    return _begun(jobs, "verify", work, entry, response)


@router.post("/whatif", status_code=202, responses=documented(422))
def whatif_recording(
    engine: EngineDep, library: LibraryDep, jobs: JobsDep, recording_id: str, ask: WhatIfAsk, response: Response
) -> Job:
    """Begin to do the session again under other settings; the result says in words what would have been different."""
    entry = _whole(engine, library, recording_id)
    changed(engine.settings, ask.settings)  # refused before the job begins

    def work(progress: JobProgress) -> Mapping[str, Any]:
        return in_process(recording_work.again, (entry.path, ask.settings), progress)

    return _begun(jobs, "whatif", work, entry, response)


def _whole(engine: Engine, library: Library, recording_id: str) -> Entry:
    entry = library.find(recording_id)
    session = engine.session
    if session is not None and session.recording_now and session.recording == entry.id:
        raise Refused(409, f"'{entry.id}' is being recorded; end its session first")
    return entry


def _begun(
    jobs: Jobs, kind: str, work: Callable[[JobProgress], Mapping[str, Any]], entry: Entry, response: Response
) -> Job:
    job = jobs.start(kind, work, entry.id)
    response.headers["Location"] = f"/api/v1/jobs/{job.id}"
    return job
