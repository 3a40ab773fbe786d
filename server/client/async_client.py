"""The asynchronous client: the same methods, awaited."""

from __future__ import annotations

import asyncio
import ssl
from collections.abc import AsyncIterator, Mapping
from pathlib import Path
from types import TracebackType
from typing import Any, Self, TypeVar

import httpx
from websockets.asyncio.client import connect
from websockets.exceptions import ConnectionClosed

from server import wire
from server.api.models import FruitState, Health, Recording, ReplayState, SessionState, Story, VirtualOperator
from server.client import calls
from server.client.calls import Call
from server.client.link import FIRST_RETRY_S, LONGEST_RETRY_S, NO_PICTURES, Link, StreamMessage
from server.client.show import Jpeg
from server.jobs import Job

T = TypeVar("T")


class AsyncTeleopClient:
    """One server; see TeleopClient. Errors and arguments are the same."""

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
        self._http = httpx.AsyncClient(
            base_url=self._link.api, headers=self._link.headers, timeout=timeout_s, verify=verify
        )

    # what is

    async def health(self) -> Health:
        """Whether the engine runs."""
        return await self._do(calls.HEALTH)

    async def state(self) -> wire.State:
        """Everything at this moment."""
        return await self._do(calls.STATE)

    async def states(self, reconnect: bool = False) -> AsyncIterator[wire.State]:
        """States as they come, about 30 a second; ends when the server does, unless it is to connect again."""
        async for message in self.messages(reconnect):
            if isinstance(message, wire.State):
                yield message

    async def messages(self, reconnect: bool = False) -> AsyncIterator[StreamMessage]:
        """All text messages of the stream; a slow reader misses states, never events, also across a reconnect."""
        retry_s = FIRST_RETRY_S
        while True:
            try:
                async with connect(
                    self._link.stream_url,
                    max_size=None,
                    additional_headers=self._link.headers,
                    ssl=self._link.tls(self._verify),
                ) as socket:
                    await socket.send(NO_PICTURES)
                    async for message in socket:
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
            await asyncio.sleep(retry_s)
            retry_s = min(LONGEST_RETRY_S, 2 * retry_s)

    async def urdf(self) -> str:
        """The robot's description."""
        return await self._do(calls.URDF)

    async def head_jpeg(self) -> Jpeg:
        """What the head camera sees."""
        return await self._do(calls.HEAD)

    # who commands

    async def access(self) -> wire.Access:
        """Who this client is and who holds the lease."""
        return await self._do(calls.ACCESS)

    async def request_lease(self) -> wire.Access:
        """Ask to command; ``holds_lease`` says whether it was granted at once."""
        return await self._do(calls.lease("request"))

    async def release_lease(self) -> wire.Access:
        """Give the lease up, or withdraw the request."""
        return await self._do(calls.lease("release"))

    async def grant_lease(self, to: str) -> wire.Access:
        """Hand the lease over to a party that asks."""
        return await self._do(calls.lease("grant", to))

    async def deny_lease(self, to: str) -> wire.Access:
        """Turn a request down."""
        return await self._do(calls.lease("deny", to))

    async def take_lease(self) -> wire.Access:
        """Take the lease over, as a supervisor."""
        return await self._do(calls.lease("take"))

    # commands

    async def engage(self) -> None:
        """Take the person who is seen as the operator."""
        await self._do(calls.ENGAGE)

    async def disengage(self) -> None:
        """Nobody is in control any more."""
        await self._do(calls.DISENGAGE)

    async def estop(self) -> None:
        """Stop everything until :meth:`estop_reset`."""
        await self._do(calls.ESTOP)

    async def estop_reset(self) -> None:
        """Release the emergency stop."""
        await self._do(calls.ESTOP_RESET)

    async def command(self, **wanted: Any) -> None:
        """Direct control; keywords as in server.api.models.RobotAsk (lift_m=..., drive_m_s=...)."""
        await self._do(calls.command(wanted))

    async def config(self) -> dict[str, Any]:
        """Every setting in force."""
        return await self._do(calls.CONFIG)

    async def configure(self, patch: Mapping[str, Any]) -> dict[str, Any]:
        """Lay a partial tree over the settings."""
        return await self._do(calls.configure(patch))

    # assisted picks

    async def fruits(self) -> list[FruitState]:
        """All fruit that the robot knows of, and what became of it."""
        return await self._do(calls.FRUITS)

    async def pick(self, fruit: str | None = None, *, preview: bool = False) -> wire.TaskState:
        """Begin an assisted pick, of the nearest ripe fruit when none is named; a refused one says what to do."""
        return await self._do(calls.pick(fruit, preview))

    async def tasks(self) -> list[wire.TaskState]:
        """Assisted picks, newest first."""
        return await self._do(calls.TASKS)

    async def task(self, task_id: str) -> wire.TaskState:
        """One assisted pick as it stands."""
        return await self._do(calls.task(task_id))

    async def confirm(self, task_id: str) -> wire.TaskState:
        """Let a previewed pick begin."""
        return await self._do(calls.confirm_task(task_id))

    async def cancel(self, task_id: str) -> wire.TaskState:
        """End a pick; the robot stops where it is."""
        return await self._do(calls.cancel_task(task_id))

    async def ended(self, task_id: str, poll_s: float = 0.1) -> wire.TaskState:
        """The pick, once it is over."""
        while (task := await self.task(task_id)).ended is None:
            await asyncio.sleep(poll_s)
        return task

    async def drive_virtual(self, **change: Any) -> VirtualOperator:
        """Tell the rendered operator of ``virtual:live`` what to do, such as x_m=0.2 or right={"side_deg": 60}."""
        return await self._do(calls.drive_virtual(change))

    # sessions and replay

    async def open(self, source: str, *, loop: bool = False, record: bool = False) -> SessionState:
        """Play a recording of the library, or read a live source."""
        return await self._do(calls.open_session(source, loop, record))

    async def sessions(self) -> list[SessionState]:
        """Running and finished sessions, oldest first."""
        return await self._do(calls.SESSIONS)

    async def close_session(self, session_id: str) -> None:
        """End a session."""
        await self._do(calls.close_session(session_id))

    async def play(self) -> ReplayState:
        """Go on with the replay."""
        return await self._do(calls.replay("play"))

    async def pause(self) -> ReplayState:
        """Hold the replay."""
        return await self._do(calls.replay("pause"))

    async def seek(self, position_s: float) -> ReplayState:
        """Jump to a position [s]."""
        return await self._do(calls.replay("seek", {"position_s": position_s}))

    async def speed(self, speed: float) -> ReplayState:
        """Play slower or faster; 1 is real time."""
        return await self._do(calls.replay("speed", {"speed": speed}))

    async def loop(self, loop: bool) -> ReplayState:
        """Begin again at the end, or stop there."""
        return await self._do(calls.replay("loop", {"loop": loop}))

    # recordings and jobs

    async def recordings(self) -> list[Recording]:
        """The library."""
        return await self._do(calls.RECORDINGS)

    async def upload(self, path: Path) -> Recording:
        """Add a recording to the library under its file name."""
        with path.open("rb") as file:
            return calls.read_recording(await self._send("POST", "/recordings", files={"file": (path.name, file)}))

    async def download(self, recording_id: str, path: Path) -> None:
        """Fetch a recording."""
        await self._fetch(f"/recordings/{recording_id}", path)

    async def delete_recording(self, recording_id: str) -> None:
        """Remove an own recording."""
        await self._do(calls.delete_recording(recording_id))

    async def story(self, recording_id: str) -> Story:
        """What happened in a recording: events and modes by position."""
        return await self._do(calls.story(recording_id))

    async def export(self, recording_id: str, format: str) -> Job:
        """Begin to export a recording: csv, mp4, lerobot, fakenect. See :meth:`wait` and :meth:`download_file`."""
        return await self._do(calls.begin(recording_id, "export", {"format": format}))

    async def track(self, recording_id: str) -> Job:
        """Begin to track a recording anew under the present settings."""
        return await self._do(calls.begin(recording_id, "track"))

    async def verify(self, recording_id: str) -> Job:
        """Begin to do a recorded session again and compare."""
        return await self._do(calls.begin(recording_id, "verify"))

    async def what_if(self, recording_id: str, settings: Mapping[str, Any]) -> Job:
        """Begin to do a recorded session again under other settings; the result says what would have been different."""
        return await self._do(calls.begin(recording_id, "whatif", {"settings": dict(settings)}))

    async def jobs(self) -> list[Job]:
        """Long jobs, newest first."""
        return await self._do(calls.JOBS)

    async def wait(self, job_id: str, poll_s: float = 0.2) -> Job:
        """The job, once it is done, failed or cancelled."""
        while (job := await self._do(calls.job(job_id))).ended is None:
            await asyncio.sleep(poll_s)
        return job

    async def download_file(self, job_id: str, path: Path) -> None:
        """Fetch the file that a job has made."""
        await self._fetch(f"/jobs/{job_id}/file", path)

    async def cancel_job(self, job_id: str) -> Job:
        """Tell a long job to end."""
        return await self._do(calls.cancel_job(job_id))

    async def request(self, method: str, path: str, body: Any = None) -> Any:
        """Any route below /api/v1, as plain JSON."""
        return await self._do(calls.any_call(method, path, body))

    async def close(self) -> None:
        """Close the connection."""
        await self._http.aclose()

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()

    def __repr__(self) -> str:
        return f"AsyncTeleopClient({self._link.url!r})"

    async def _fetch(self, path: str, to: Path) -> None:
        async with self._http.stream("GET", path) as response:
            if response.is_error:
                await response.aread()
                raise calls.refusal(response)
            with to.open("wb") as file:
                async for chunk in response.aiter_bytes():
                    file.write(chunk)

    async def _do(self, call: Call[T]) -> T:
        return call.answer(await self._send(call.method, call.path, json=call.json))

    async def _send(self, method: str, path: str, **given: Any) -> httpx.Response:
        try:
            return await self._http.request(method, path, **given)
        except httpx.TransportError as error:
            raise self._link.absent(error) from error
