"""Long jobs: what runs, how far it is, what came of it; and cancelling."""

from __future__ import annotations

from fastapi import APIRouter
from fastapi.responses import FileResponse

from server.api.deps import JobsDep
from server.api.problems import documented
from server.jobs import Job

router = APIRouter(prefix="/jobs", tags=["jobs"])


@router.get("")
def list_jobs(jobs: JobsDep) -> list[Job]:
    """Newest first; the last hundred finished ones are remembered."""
    return jobs.all()


@router.get("/{job_id}", responses=documented(404))
def read_job(jobs: JobsDep, job_id: str) -> Job:
    """One job as it stands."""
    return jobs.find(job_id)


@router.get("/{job_id}/file", response_class=FileResponse, responses=documented(404, 409))
def download_job_file(jobs: JobsDep, job_id: str) -> FileResponse:
    """The file that a job has made, such as an export."""
    path = jobs.file(job_id)
    return FileResponse(path, media_type="application/octet-stream", filename=path.name)


@router.delete("/{job_id}", responses=documented(404))
def cancel_job(jobs: JobsDep, job_id: str) -> Job:
    """Tell a job to end, or remove the file of a finished one; doing so twice does no harm."""
    return jobs.cancel(job_id)
