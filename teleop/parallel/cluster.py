"""Workers of a Dask cluster: whoever has joined the scheduler.

Workers need the same software as the caller, which is checked, and see files under the same paths as the caller.
"""

from __future__ import annotations

import socket
from collections.abc import Callable, Iterator, Sequence
from typing import Any, TypeVar
from urllib.parse import urlsplit

from teleop.errors import TeleopError
from teleop.parallel.outcome import Outcome, WorkerLost, attempt

T = TypeVar("T")
R = TypeVar("R")

_CONNECT_S = 10


class DaskPool:
    """A client of one scheduler."""

    def __init__(self, address: str, software: Callable[[], str]) -> None:
        """address: such as tcp://host:8786. software: tells workers' versions apart, called here and on each of them.

        Raises TeleopError: no Dask, no scheduler, no workers, other software.
        """
        try:
            from distributed import Client
        except ImportError as error:
            raise TeleopError(f"--scheduler needs Dask ({error}); pip install 'greenhouse-teleop[cluster]'") from None
        try:
            _knock(address)
            self._client: Any = Client(address, timeout=_CONNECT_S, set_as_default=False)
        except (OSError, ValueError) as error:
            raise TeleopError(
                f"no Dask scheduler at {address} ({_line(error)}); start one with 'dask scheduler', "
                "then 'dask worker ADDRESS' on each machine, and give its address as tcp://host:8786"
            ) from None
        try:
            self._require_like_workers(address, software)
        except BaseException:
            self.close()
            raise

    @property
    def workers(self) -> int:
        """Threads of all workers that have joined by now."""
        return sum(self._client.nthreads().values())

    def run(self, work: Callable[[T], R], tasks: Sequence[T]) -> Iterator[Outcome[T, R]]:
        """Outcomes as they come. Leaving the iteration early cancels what has not begun."""
        from distributed import as_completed

        number_of = {
            self._client.submit(attempt, work, task, pure=False, retries=0): number for number, task in enumerate(tasks)
        }
        try:
            for future in as_completed(list(number_of), loop=self._client.loop):
                number = number_of.pop(future)
                yield _outcome(future, number, tasks[number])
        finally:
            self._client.cancel(list(number_of))

    def close(self) -> None:
        """Leave the cluster; its workers stay."""
        self._client.close()

    def _require_like_workers(self, address: str, software: Callable[[], str]) -> None:
        if not self._client.nthreads():
            raise TeleopError(f"the scheduler at {address} has no workers; start some with 'dask worker {address}'")
        try:
            theirs = self._client.run(software)
        except ImportError as error:
            raise TeleopError(f"a worker of {address} lacks this software ({error}); install it there") from None
        ours = software()
        unlike = sorted(worker for worker, version in theirs.items() if version != ours)
        if unlike:
            raise TeleopError(f"worker {unlike[0]} runs another version of this software; install the same one there")


def _knock(address: str) -> None:
    """See that somebody listens there: Dask's client, made in vain, takes long and complains when it is dropped."""
    url = urlsplit(address)
    if url.scheme not in ("tcp", "tls") or not url.hostname or not url.port:
        raise ValueError("not an address of the form tcp://host:port")
    socket.create_connection((url.hostname, url.port), _CONNECT_S).close()


def _outcome(future: Any, number: int, task: Any) -> Outcome[Any, Any]:
    if future.status == "finished":
        result, error = future.result()
        return Outcome(number, task, result, error)
    why = future.exception() if future.status == "error" else "the scheduler is gone"
    return Outcome(number, task, error=WorkerLost(f"its worker was lost: {_line(why)}"))


def _line(error: object) -> str:
    return " ".join(str(error).split()) or type(error).__name__
