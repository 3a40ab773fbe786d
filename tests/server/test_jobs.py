"""Long jobs: status, progress, result, failure, cancelling; the last ones are remembered."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import pytest

from server.errors import Refused
from server.jobs import Job, JobProgress, Jobs
from teleop.errors import TeleopError


@pytest.fixture
def jobs() -> Iterator[Jobs]:
    made = Jobs(workers=1, kept=3, waiting=4)
    yield made
    made.close()


def until(jobs: Jobs, job: Job, true: Callable[[Job], bool]) -> Job:
    end_s = time.monotonic() + 20.0
    while time.monotonic() < end_s:
        if true(found := jobs.find(job.id)):
            return found
        time.sleep(0.005)
    raise AssertionError(f"it never came true: {jobs.find(job.id)}")


def ended(job: Job) -> bool:
    return job.ended is not None


def test_a_job_tells_how_far_it_is_and_what_came_of_it(jobs: Jobs) -> None:
    go = threading.Event()

    def work(progress: JobProgress) -> Mapping[str, Any]:
        progress.report(0.5, "half")
        assert go.wait(20)
        return {"rows": 3}

    job = jobs.start("export", work, "walk")
    half = until(jobs, job, lambda j: j.progress == 0.5)
    assert (half.status, half.message, half.ended) == ("running", "half", None)
    go.set()
    done = until(jobs, job, ended)
    assert (done.status, done.progress, done.result, done.error) == ("done", 1.0, {"rows": 3}, None)
    assert done.created <= (done.started or 0) <= (done.ended or 0)


def test_a_failure_is_one_line_and_a_bug_goes_to_the_log(jobs: Jobs, caplog: pytest.LogCaptureFixture) -> None:
    def fails(_: JobProgress) -> Mapping[str, Any]:
        raise TeleopError("no such folder; choose another")

    def breaks(_: JobProgress) -> Mapping[str, Any]:
        raise ZeroDivisionError

    assert until(jobs, jobs.start("a", fails), ended).error == "no such folder; choose another"
    broken = until(jobs, jobs.start("b", breaks), ended)
    assert broken.status == "failed" and broken.error == "ZeroDivisionError; see the server's log"
    assert "ZeroDivisionError" in caplog.text


def test_cancelling_ends_a_running_job_a_waiting_one_and_leaves_a_finished_one(jobs: Jobs) -> None:
    begun = threading.Event()

    def endless(progress: JobProgress) -> Mapping[str, Any]:
        while True:
            begun.set()
            progress.report(0.1)
            time.sleep(0.005)

    running, waiting = jobs.start("a", endless), jobs.start("b", lambda _: {})
    assert begun.wait(20)
    assert jobs.cancel(waiting.id).status == "cancelled"
    jobs.cancel(running.id)
    assert until(jobs, running, ended).status == "cancelled"
    assert jobs.cancel(running.id).status == "cancelled"
    assert jobs.find(waiting.id).started is None


def test_only_so_many_wait_and_only_the_last_are_remembered(jobs: Jobs) -> None:
    go = threading.Event()

    def held(_: JobProgress) -> Mapping[str, Any]:
        assert go.wait(20)
        return {}

    started = [jobs.start(str(i), held) for i in range(4)]
    with pytest.raises(Refused, match="4 jobs are waiting") as refused:
        jobs.start("more", held)
    assert refused.value.status == 503
    go.set()
    for job in started:
        until(jobs, job, ended)
    for i in range(3):
        until(jobs, jobs.start(f"later {i}", lambda _: {}), ended)
    assert [job.kind for job in jobs.all()][:3] == ["later 2", "later 1", "later 0"] and len(jobs.all()) <= 5
    with pytest.raises(Refused, match="no job"):
        jobs.find(started[0].id)
