"""The requests of the API as values: no socket, no waiting; both clients send the same ones."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import httpx
from pydantic import TypeAdapter

from server import wire
from server.api.models import FruitState, Health, Recording, ReplayState, RobotAsk, SessionState, Story, VirtualOperator
from server.client.show import Jpeg
from server.errors import Refused
from server.jobs import Job

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Call(Generic[T]):
    """One request and how its answer is read. path: below /api/v1."""

    method: str
    path: str
    read: Callable[[httpx.Response], T]
    json: Any = None

    def answer(self, response: httpx.Response) -> T:
        """What was asked for. Raises Refused with the server's own words."""
        if response.is_error:
            raise refusal(response)
        return self.read(response)


def refusal(response: httpx.Response) -> Refused:
    """The server's own words; its status line when an intermediary answered."""
    if response.headers.get("content-type", "").startswith("application/problem+json"):
        body = response.json()
        return Refused(response.status_code, str(body["detail"]), body.get("code"))
    return Refused(response.status_code, f"{response.status_code} {response.reason_phrase}")


def _of(kind: type[T]) -> Callable[[httpx.Response], T]:
    adapter = TypeAdapter(kind)
    return lambda response: adapter.validate_json(response.content)


def _nothing(_: httpx.Response) -> None:
    return None


_STATE, _HEALTH, _ACCESS, _SESSION = _of(wire.State), _of(Health), _of(wire.Access), _of(SessionState)
_REPLAY, _RECORDING, _JOB = _of(ReplayState), _of(Recording), _of(Job)
_SESSIONS, _RECORDINGS, _JOBS = _of(list[SessionState]), _of(list[Recording]), _of(list[Job])
_TASK, _TASKS, _FRUITS = _of(wire.TaskState), _of(list[wire.TaskState]), _of(list[FruitState])
_STORY, _VIRTUAL = _of(Story), _of(VirtualOperator)
_TREE = _of(dict[str, Any])

HEALTH = Call("GET", "/health", _HEALTH)
STATE = Call("GET", "/state", _STATE)
ACCESS = Call("GET", "/access", _ACCESS)
ENGAGE = Call("POST", "/engage", _nothing)
DISENGAGE = Call("POST", "/disengage", _nothing)
ESTOP = Call("POST", "/estop", _nothing)
ESTOP_RESET = Call("POST", "/estop/reset", _nothing)
CONFIG = Call("GET", "/config", _TREE)
SESSIONS = Call("GET", "/sessions", _SESSIONS)
RECORDINGS = Call("GET", "/recordings", _RECORDINGS)
TASKS = Call("GET", "/tasks", _TASKS)
FRUITS = Call("GET", "/fruits", _FRUITS)
JOBS = Call("GET", "/jobs", _JOBS)
URDF = Call("GET", "/robot/urdf", lambda response: response.text)
HEAD = Call("GET", "/camera/head.jpg", lambda response: Jpeg(response.content))


def lease(action: str, to: str | None = None) -> Call[wire.Access]:
    """request, release, grant, deny, take."""
    return Call("POST", f"/lease/{action}", _ACCESS, None if to is None else {"to": to})


def command(wanted: Mapping[str, Any]) -> Call[None]:
    """Raises ValidationError for what cannot be asked of the robot."""
    return Call("POST", "/robot/command", _nothing, RobotAsk.model_validate(wanted).model_dump(exclude_unset=True))


def pick(fruit: str | None, preview: bool) -> Call[wire.TaskState]:
    """Begin an assisted pick."""
    return Call("POST", "/tasks/pick", _TASK, {"fruit": fruit, "preview": preview})


def task(task_id: str) -> Call[wire.TaskState]:
    """One task as it stands."""
    return Call("GET", f"/tasks/{task_id}", _TASK)


def confirm_task(task_id: str) -> Call[wire.TaskState]:
    """Let a previewed pick begin."""
    return Call("POST", f"/tasks/{task_id}/confirm", _TASK)


def cancel_task(task_id: str) -> Call[wire.TaskState]:
    """End a task."""
    return Call("DELETE", f"/tasks/{task_id}", _TASK)


def configure(patch: Mapping[str, Any]) -> Call[dict[str, Any]]:
    """A partial tree over the settings."""
    return Call("PATCH", "/config", _TREE, dict(patch))


def open_session(source: str, loop: bool, record: bool) -> Call[SessionState]:
    """A recording of the library, or a live source."""
    return Call("POST", "/sessions", _SESSION, {"source": source, "loop": loop, "record": record})


def close_session(session_id: str) -> Call[None]:
    """End a session."""
    return Call("DELETE", f"/sessions/{session_id}", _nothing)


def replay(action: str, body: Mapping[str, Any] | None = None) -> Call[ReplayState]:
    """play, pause, seek, speed, loop."""
    return Call("POST", f"/replay/{action}", _REPLAY, body)


def delete_recording(recording_id: str) -> Call[None]:
    """Remove an own recording."""
    return Call("DELETE", f"/recordings/{recording_id}", _nothing)


def read_recording(response: httpx.Response) -> Recording:
    """The answer to an upload. Raises Refused."""
    return Call("POST", "/recordings", _RECORDING).answer(response)


def story(recording_id: str) -> Call[Story]:
    """What happened in a recording."""
    return Call("GET", f"/recordings/{recording_id}/story", _STORY)


def job(job_id: str) -> Call[Job]:
    """One long job as it stands."""
    return Call("GET", f"/jobs/{job_id}", _JOB)


def begin(recording_id: str, what: str, body: Mapping[str, Any] | None = None) -> Call[Job]:
    """A long job over a recording: export, track, verify, whatif."""
    return Call("POST", f"/recordings/{recording_id}/{what}", _JOB, body)


def cancel_job(job_id: str) -> Call[Job]:
    """Tell a long job to end."""
    return Call("DELETE", f"/jobs/{job_id}", _JOB)


def drive_virtual(change: Mapping[str, Any]) -> Call[VirtualOperator]:
    """Tell the rendered operator of ``virtual:live`` what to do; nothing asks what they were told."""
    return Call("PATCH" if change else "GET", "/virtual", _VIRTUAL, dict(change) or None)


def any_call(method: str, path: str, body: Any = None) -> Call[Any]:
    """A route that has no method here; the answer as plain JSON."""
    return Call(method, path, lambda response: response.json() if response.content else None, body)
