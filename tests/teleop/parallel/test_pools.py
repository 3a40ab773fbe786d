"""Both kinds of workers through the same interface: processes here, and a real Dask cluster of two processes."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import parallel_tasks as tasks
import pytest

from teleop.errors import SourceError, TeleopError
from teleop.parallel import Pool, WorkerLost, in_order, open_pool
from teleop.software import sources_digest

_HERE = str(Path(__file__).parent)


@pytest.fixture(scope="module")
def scheduler() -> Iterator[str]:
    distributed = pytest.importorskip("distributed", reason="Dask is not installed: extra 'cluster'")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", _HERE)  # workers import the tasks, too
        with distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50
        ) as cluster:
            yield cluster.scheduler_address


@pytest.fixture(params=["local", "dask"])
def pool(request: pytest.FixtureRequest) -> Iterator[Pool]:
    address = request.getfixturevalue("scheduler") if request.param == "dask" else None
    with open_pool(2, address, tasks.version_one) as pool:
        yield pool


def test_every_task_has_one_outcome(pool: Pool) -> None:
    outcomes = list(in_order(pool.run(tasks.square, range(23))))
    assert [o.number for o in outcomes] == list(range(23))
    assert [o.value() for o in outcomes] == [n * n for n in range(23)]
    assert pool.workers == 2 and list(pool.run(tasks.square, [])) == []


def test_work_is_shared_by_other_processes(pool: Pool) -> None:
    pids = {o.value() for o in pool.run(tasks.where, range(20))}
    assert len(pids) == 2 and os.getpid() not in pids


def test_early_outcomes_wait_for_their_turn(pool: Pool) -> None:
    assert [o.value() for o in in_order(pool.run(tasks.late_first, range(5)))] == list(range(5))


def test_an_error_takes_only_its_own_task_along(pool: Pool) -> None:
    outcomes = list(in_order(pool.run(tasks.troubled, [0, 1, 2, 3, 5])))
    assert [o.number for o in outcomes if o.error is None] == [0, 1, 4]
    with pytest.raises(SourceError, match="no camera 2"):
        outcomes[2].value()
    with pytest.raises(ZeroDivisionError) as bug:
        outcomes[3].value()
    assert "parallel_tasks.py" in bug.value.__notes__[0]  # the worker's traceback


def test_a_worker_that_dies_takes_only_its_own_task_along() -> None:
    with open_pool(2, None, tasks.version_one) as pool:
        outcomes = list(in_order(pool.run(tasks.troubled, [0, 4, 1, 5, 6])))
        assert [o.result for o in outcomes] == [0, None, 1, 5, 6]
        assert isinstance(outcomes[1].error, WorkerLost) and "SIGKILL" in str(outcomes[1].error)
        assert [o.value() for o in in_order(pool.run(tasks.square, range(4)))] == [0, 1, 4, 9]


def test_leaving_early_ends_the_work(tmp_path: Path) -> None:
    said = tmp_path / "pid"
    with open_pool(2, None, tasks.version_one) as pool:
        outcomes = pool.run(_square_or_wait, [3, str(said)])
        assert next(outcomes).value() == 9
        pid = _pid(said)
        outcomes.close()
    assert not _runs(pid)


def test_workers_end_with_their_parent(tmp_path: Path) -> None:
    said = tmp_path / "pid"
    code = (
        "import parallel_tasks as t; from teleop.parallel import open_pool\n"
        f"with open_pool(1, None, t.version_one) as pool: list(pool.run(t.wait_for, [{str(said)!r}]))"
    )
    parent = subprocess.Popen([sys.executable, "-c", code], env=os.environ | {"PYTHONPATH": _HERE})
    pid = _pid(said)
    parent.kill()
    parent.wait()
    deadline = time.monotonic() + 10
    while _runs(pid) and time.monotonic() < deadline:
        time.sleep(0.02)
    assert not _runs(pid)


def test_a_scheduler_that_cannot_be_used_is_said(scheduler: str, monkeypatch: pytest.MonkeyPatch) -> None:
    with (
        pytest.raises(TeleopError, match="another version of this software"),
        open_pool(None, scheduler, tasks.version_of_process),
    ):
        pass
    monkeypatch.setattr("teleop.parallel.cluster._CONNECT_S", 0.5)
    for address in ("tcp://127.0.0.1:9", "nowhere", "xyz://a:1", "tcp://127.0.0.1:99999"):
        with pytest.raises(TeleopError, match="no Dask scheduler at"), open_pool(None, address, tasks.version_one):
            pass


def test_the_digest_tells_sources_apart() -> None:
    whole = sources_digest("teleop")
    assert len(whole) == 64 and whole == sources_digest("teleop")
    assert len({whole, sources_digest("robot_sim"), sources_digest("teleop", without=("teleop.people",))}) == 3


def _square_or_wait(task: int | str) -> int:
    return tasks.square(task) if isinstance(task, int) else tasks.wait_for(task)


def _pid(said: Path) -> int:
    deadline = time.monotonic() + 30
    while not (said.is_file() and said.read_text()):
        assert time.monotonic() < deadline
        time.sleep(0.02)
    return int(said.read_text())


def _runs(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False
