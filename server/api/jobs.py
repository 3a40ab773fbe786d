"""Long jobs: what runs, how far it is, what came of it; and cancelling."""

from __future__ import annotations

from fastapi import APIRouter

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


@router.delete("/{job_id}", responses=documented(404))
def cancel_job(jobs: JobsDep, job_id: str) -> Job:
    """Tell a job to end; cancelling twice, or a finished one, does no harm."""
    return jobs.cancel(job_id)
