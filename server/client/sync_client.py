"""The blocking client."""

from __future__ import annotations

import ssl
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import TracebackType
from typing import Any, Self, TypeVar

import httpx
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from server import wire
from server.api.models import FruitState, Health, Recording, ReplayState, SessionState, Story, VirtualOperator
from server.client import calls
from server.client.calls import Call
from server.client.link import FIRST_RETRY_S, LONGEST_RETRY_S, NO_PICTURES, Link, StreamMessage
from server.client.show import Jpeg, client_html
from server.jobs import Job

T = TypeVar("T")


class TeleopClient:
    """One server. Every method raises Refused (with its HTTP status) when the server says no, ServerError when it
    does not answer. token: of a role, needed from another machine ($TELEOP_TOKEN by default)."""

    def __init__(
        self,
        url: str = "http://127.0.0.1:8000",
        timeout_s: float = 30.0,
        *,
        token: str | None = None,
        name: str = "python",
        verify: ssl.SSLContext | bool = True,
    ) -> None:
        self._link = Link(url, token, name)
        self._verify = verify
        self._http = httpx.Client(base_url=self._link.api, headers=self._link.headers, timeout=timeout_s, verify=verify)

    # what is

    def health(self) -> Health:
        """Whether the engine runs."""
        return self._do(calls.HEALTH)

    def state(self) -> wire.State:
        """Everything at this moment."""
        return self._do(calls.STATE)

    def states(self, reconnect: bool = False) -> Iterator[wire.State]:
        """States as they come, about 30 a second; ends when the server does, unless it is to connect again."""
        yield from (message for message in self.messages(reconnect) if isinstance(message, wire.State))

    def messages(self, reconnect: bool = False) -> Iterator[StreamMessage]:
        """All text messages of the stream; a slow reader misses states, never events, also across a reconnect."""
        retry_s = FIRST_RETRY_S
        while True:
            try:
                with connect(
                    self._link.stream_url,
                    max_size=None,
                    additional_headers=self._link.headers,
                    ssl=self._link.tls(self._verify),
                ) as socket:
                    socket.send(NO_PICTURES)
                    for message in socket:
                        retry_s = FIRST_RETRY_S
                        if isinstance(message, str):
                            yield self._link.read(message)
            except ConnectionClosed as closed:
                self._link.ended(closed)
            except OSError as error:
                if not reconnect:
                    raise self._link.absent(error) from error
            if not reconnect:
                return
            time.sleep(retry_s)
            retry_s = min(LONGEST_RETRY_S, 2 * retry_s)

    def urdf(self) -> str:
        """The robot's description."""
        return self._do(calls.URDF)

    def head_jpeg(self) -> Jpeg:
        """What the head camera sees."""
        return self._do(calls.HEAD)

    # who commands

    def access(self) -> wire.Access:
        """Who this client is and who holds the lease."""
        return self._do(calls.ACCESS)

    def request_lease(self) -> wire.Access:
        """Ask to command; ``holds_lease`` says whether it was granted at once."""
        return self._do(calls.lease("request"))

    def release_lease(self) -> wire.Access:
        """Give the lease up, or withdraw the request."""
        return self._do(calls.lease("release"))

    def grant_lease(self, to: str) -> wire.Access:
        """Hand the lease over to a party that asks."""
        return self._do(calls.lease("grant", to))

    def deny_lease(self, to: str) -> wire.Access:
        """Turn a request down."""
        return self._do(calls.lease("deny", to))

    def take_lease(self) -> wire.Access:
        """Take the lease over, as a supervisor."""
        return self._do(calls.lease("take"))

    # commands

    def engage(self) -> None:
        """Take the person who is seen as the operator."""
        self._do(calls.ENGAGE)

    def disengage(self) -> None:
        """Nobody is in control any more."""
        self._do(calls.DISENGAGE)

    def estop(self) -> None:
        """Stop everything until :meth:`estop_reset`."""
        self._do(calls.ESTOP)

    def estop_reset(self) -> None:
        """Release the emergency stop."""
        self._do(calls.ESTOP_RESET)

    def command(self, **wanted: Any) -> None:
        """Direct control; keywords as in server.api.models.RobotAsk (lift_m=..., drive_m_s=...)."""
        self._do(calls.command(wanted))

    def config(self) -> dict[str, Any]:
        """Every setting in force."""
        return self._do(calls.CONFIG)

    def configure(self, patch: Mapping[str, Any]) -> dict[str, Any]:
        """Lay a partial tree over the settings."""
        return self._do(calls.configure(patch))

    # assisted picks

    def fruits(self) -> list[FruitState]:
        """All fruit that the robot knows of, and what became of it."""
        return self._do(calls.FRUITS)

    def pick(self, fruit: str | None = None, *, preview: bool = False) -> wire.TaskState:
        """Begin an assisted pick, of the nearest ripe fruit when none is named; a refused one says what to do."""
        return self._do(calls.pick(fruit, preview))

    def tasks(self) -> list[wire.TaskState]:
        """Assisted picks, newest first."""
        return self._do(calls.TASKS)

    def task(self, task_id: str) -> wire.TaskState:
        """One assisted pick as it stands."""
        return self._do(calls.task(task_id))

    def confirm(self, task_id: str) -> wire.TaskState:
        """Let a previewed pick begin."""
        return self._do(calls.confirm_task(task_id))

    def cancel(self, task_id: str) -> wire.TaskState:
        """End a pick; the robot stops where it is."""
        return self._do(calls.cancel_task(task_id))

    def ended(self, task_id: str, poll_s: float = 0.1) -> wire.TaskState:
        """The pick, once it is over."""
        while (task := self.task(task_id)).ended is None:
            time.sleep(poll_s)
        return task

    def drive_virtual(self, **change: Any) -> VirtualOperator:
        """Tell the rendered operator of ``virtual:live`` what to do, such as x_m=0.2 or right={"side_deg": 60}."""
        return self._do(calls.drive_virtual(change))

    # sessions and replay

    def open(self, source: str, *, loop: bool = False, record: bool = False) -> SessionState:
        """Play a recording of the library, or read a live source."""
        return self._do(calls.open_session(source, loop, record))

    def sessions(self) -> list[SessionState]:
        """Running and finished sessions, oldest first."""
        return self._do(calls.SESSIONS)

    def close_session(self, session_id: str) -> None:
        """End a session."""
        self._do(calls.close_session(session_id))

    def play(self) -> ReplayState:
        """Go on with the replay."""
        return self._do(calls.replay("play"))

    def pause(self) -> ReplayState:
        """Hold the replay."""
        return self._do(calls.replay("pause"))

    def seek(self, position_s: float) -> ReplayState:
        """Jump to a position [s]."""
        return self._do(calls.replay("seek", {"position_s": position_s}))

    def speed(self, speed: float) -> ReplayState:
        """Play slower or faster; 1 is real time."""
        return self._do(calls.replay("speed", {"speed": speed}))

    def loop(self, loop: bool) -> ReplayState:
        """Begin again at the end, or stop there."""
        return self._do(calls.replay("loop", {"loop": loop}))

    # recordings and jobs

    def recordings(self) -> list[Recording]:
        """The library."""
        return self._do(calls.RECORDINGS)

    def upload(self, path: Path) -> Recording:
        """Add a recording to the library under its file name."""
        with path.open("rb") as file:
            return calls.read_recording(self._send("POST", "/recordings", files={"file": (path.name, file)}))

    def download(self, recording_id: str, path: Path) -> None:
        """Fetch a recording."""
        self._fetch(f"/recordings/{recording_id}", path)

    def delete_recording(self, recording_id: str) -> None:
        """Remove an own recording."""
        self._do(calls.delete_recording(recording_id))

    def story(self, recording_id: str) -> Story:
        """What happened in a recording: events and modes by position."""
        return self._do(calls.story(recording_id))

    def export(self, recording_id: str, format: str) -> Job:
        """Begin to export a recording: csv, mp4, lerobot, fakenect. See :meth:`wait` and :meth:`download_file`."""
        return self._do(calls.begin(recording_id, "export", {"format": format}))

    def track(self, recording_id: str) -> Job:
        """Begin to track a recording anew under the present settings."""
        return self._do(calls.begin(recording_id, "track"))

    def verify(self, recording_id: str) -> Job:
        """Begin to do a recorded session again and compare."""
        return self._do(calls.begin(recording_id, "verify"))

    def what_if(self, recording_id: str, settings: Mapping[str, Any]) -> Job:
        """Begin to do a recorded session again under other settings; the result says what would have been different."""
        return self._do(calls.begin(recording_id, "whatif", {"settings": dict(settings)}))

    def jobs(self) -> list[Job]:
        """Long jobs, newest first."""
        return self._do(calls.JOBS)

    def wait(self, job_id: str, poll_s: float = 0.2) -> Job:
        """The job, once it is done, failed or cancelled."""
        while (job := self._do(calls.job(job_id))).ended is None:
            time.sleep(poll_s)
        return job

    def download_file(self, job_id: str, path: Path) -> None:
        """Fetch the file that a job has made."""
        self._fetch(f"/jobs/{job_id}/file", path)

    def cancel_job(self, job_id: str) -> Job:
        """Tell a long job to end."""
        return self._do(calls.cancel_job(job_id))

    def request(self, method: str, path: str, body: Any = None) -> Any:
        """Any route below /api/v1, as plain JSON."""
        return self._do(calls.any_call(method, path, body))

    def close(self) -> None:
        """Close the connection."""
        self._http.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"TeleopClient({self._link.url!r})"

    def _repr_html_(self) -> str:
        return client_html(self._link.url, self.state(), self.access())

    def _fetch(self, path: str, to: Path) -> None:
        with self._http.stream("GET", path) as response:
            if response.is_error:
                response.read()
                raise calls.refusal(response)
            with to.open("wb") as file:
                for chunk in response.iter_bytes():
                    file.write(chunk)

    def _do(self, call: Call[T]) -> T:
        return call.answer(self._send(call.method, call.path, json=call.json))

    def _send(self, method: str, path: str, **given: Any) -> httpx.Response:
        try:
            return self._http.request(method, path, **given)
        except httpx.TransportError as error:
            raise self._link.absent(error) from error
