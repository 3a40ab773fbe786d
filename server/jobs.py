"""Long jobs: work in a few worker threads with status, progress, result and cancelling."""

from __future__ import annotations

import logging
import shutil
import tempfile
import threading
import time
import uuid
from collections import OrderedDict
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, Field

from robot_sim.errors import RobotError
from server.errors import Refused
from teleop.errors import TeleopError

JobStatus = Literal["queued", "running", "done", "failed", "cancelled"]
_log = logging.getLogger(__name__)


class Job(BaseModel):
    """One long job as it stands. Times are Unix times [s]."""

    id: str
    kind: str = Field(description="what is done, such as export or convert")
    detail: str = Field("", description="to what it is done")
    status: JobStatus = "queued"
    progress: float = Field(0.0, ge=0.0, le=1.0, description="part that is done")
    message: str = Field("", description="what it is at")
    result: dict[str, Any] | None = Field(None, description="what came of it, once done")
    error: str | None = Field(None, description="why it failed, in one line")
    created: float
    started: float | None = None
    ended: float | None = None


class JobCancelled(Exception):
    """Raised in the work of a job that was cancelled; let it pass."""


class JobProgress:
    """What the work of a job is given: it tells how far it is and learns whether it should go on."""

    def __init__(
        self, change: Callable[[Mapping[str, Any]], None], stop: threading.Event, folder: Callable[[], Path]
    ) -> None:
        self._change = change
        self._stop = stop
        self._folder = folder

    @property
    def folder(self) -> Path:
        """Where the job leaves a file that its result names as ``file``; made when it is asked for."""
        return self._folder()

    @property
    def cancelled(self) -> bool:
        """Whether somebody cancelled the job."""
        return self._stop.is_set()

    def report(self, fraction: float, message: str = "") -> None:
        """How much is done, 0 to 1. Raises JobCancelled when the job is to end."""
        if self.cancelled:
            raise JobCancelled
        self._change({"progress": min(1.0, max(0.0, fraction)), "message": message})


Work = Callable[[JobProgress], Mapping[str, Any]]


class Jobs:
    """All jobs of a server, in memory, their files in a folder that goes with the server. Thread-safe."""

    def __init__(
        self, workers: int = 2, kept: int = 100, waiting: int = 50, files_in: Callable[[], Path | None] = lambda: None
    ) -> None:
        """kept: finished jobs remembered. waiting: unfinished jobs at one time. files_in: the folder for their files,
        asked for with the first of them; None: the system's for temporary files."""
        self._files_in = files_in
        self._files: Path | None = None
        self._pool = ThreadPoolExecutor(workers, thread_name_prefix="job")
        self._kept = kept
        self._waiting = waiting
        self._lock = threading.Lock()
        self._jobs: OrderedDict[str, Job] = OrderedDict()
        self._stops: dict[str, threading.Event] = {}

    def start(self, kind: str, work: Work, detail: str = "") -> Job:
        """Queue a job. Raises Refused (503) when too many wait."""
        job = Job(id=uuid.uuid4().hex[:12], kind=kind, detail=detail, created=time.time())
        with self._lock:
            if len(self._stops) >= self._waiting:
                raise Refused(503, f"{self._waiting} jobs are waiting already; cancel one or ask again later")
            self._jobs[job.id] = job
            stop = self._stops[job.id] = threading.Event()
            finished = [key for key in self._jobs if key not in self._stops]
            for key in finished[: max(0, len(finished) - self._kept)]:
                del self._jobs[key]
                self._drop_files(key)
        self._pool.submit(self._run, job.id, work, stop)
        return job

    def all(self) -> list[Job]:
        """Newest first."""
        with self._lock:
            return list(reversed(self._jobs.values()))

    def find(self, job_id: str) -> Job:
        """Raises Refused (404)."""
        with self._lock:
            job = self._jobs.get(job_id)
        if job is None:
            raise Refused(404, f"no job '{job_id[:40]}'; list them with GET /api/v1/jobs")
        return job

    def cancel(self, job_id: str) -> Job:
        """Tell a job to end; a finished one stays as it is, but its file is removed. Raises Refused (404)."""
        job = self.find(job_id)
        with self._lock:
            stop = self._stops.get(job_id)
            if stop is not None:
                stop.set()
                if job.status == "queued":
                    self._finish(job_id, {"status": "cancelled"})
            else:
                self._drop_files(job_id)
        return self.find(job_id)

    def file(self, job_id: str) -> Path:
        """The file that a job made. Raises Refused: 404 unknown, or no file; 409 not done yet."""
        job = self.find(job_id)
        if job.ended is None:
            raise Refused(409, f"job '{job_id}' is at {100 * job.progress:.0f} %; ask again when its status is done")
        name = (job.result or {}).get("file")
        path = None if name is None or self._files is None else self._files / job_id / str(name)
        if path is None or not path.is_file():
            raise Refused(404, f"job '{job_id}' has no file (any more)")
        return path

    def close(self) -> None:
        """Tell all jobs to end and wait for those that run."""
        with self._lock:
            for stop in self._stops.values():
                stop.set()
        self._pool.shutdown(wait=True, cancel_futures=True)
        if self._files is not None:
            shutil.rmtree(self._files, ignore_errors=True)

    def _run(self, job_id: str, work: Work, stop: threading.Event) -> None:
        if stop.is_set():
            return
        self._change(job_id, {"status": "running", "started": time.time()})
        end: dict[str, Any]
        try:
            progress = JobProgress(lambda told: self._change(job_id, told), stop, lambda: self._folder(job_id))
            result = dict(work(progress))
            end = {"status": "done", "progress": 1.0, "result": result}
        except JobCancelled:
            end = {"status": "cancelled"}
        except (TeleopError, RobotError, OSError) as error:
            end = {"status": "failed", "error": str(error)}
        except BaseException as error:
            _log.exception("job %s", job_id)
            with self._lock:
                self._finish(job_id, {"status": "failed", "error": f"{type(error).__name__}; see the server's log"})
            raise
        with self._lock:
            self._finish(job_id, end)
            if end["status"] != "done":
                self._drop_files(job_id)

    def _folder(self, job_id: str) -> Path:
        with self._lock:
            if self._files is None:
                self._files = Path(tempfile.mkdtemp(prefix="teleop-jobs-", dir=self._files_in()))
        folder = self._files / job_id
        folder.mkdir(exist_ok=True)
        return folder

    def _drop_files(self, job_id: str) -> None:
        if self._files is not None:
            shutil.rmtree(self._files / job_id, ignore_errors=True)

    def _change(self, job_id: str, told: Mapping[str, Any]) -> None:
        with self._lock:
            self._jobs[job_id] = self._jobs[job_id].model_copy(update=dict(told))

    def _finish(self, job_id: str, told: Mapping[str, Any]) -> None:
        """The lock is held."""
        if self._stops.pop(job_id, None) is not None:
            self._jobs[job_id] = self._jobs[job_id].model_copy(update={"ended": time.time(), **told})
