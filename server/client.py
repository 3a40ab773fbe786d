"""A typed Python client of the API: read the state, operate the robot, manage recordings, follow the stream.

with TeleopClient() as robot:
    robot.open("greenhouse_demo", loop=False)
    for state in robot.states():
        print(state.angles.theta1_right)
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import httpx
from pydantic import TypeAdapter
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from server import wire
from server.api.operate import RobotAsk
from server.api.recordings import Recording
from server.api.replay import ReplayState
from server.api.sessions import SessionState
from server.errors import Refused, ServerError

_SERVER_MESSAGE: TypeAdapter[Any] = TypeAdapter(
    wire.ServerMessage
)
_NO_PICTURES = wire.View(image="none").model_dump_json()


class TeleopClient:
    """One server. Every method raises Refused (with its HTTP status) when the server says no, ServerError when it
    does not answer."""

    def __init__(self, url: str = "http://127.0.0.1:8000", timeout_s: float = 30.0) -> None:
        self._stream_url = f"{url.rstrip('/')}/api/v1/stream".replace("http", "ws", 1)
        self._http = httpx.Client(base_url=f"{url.rstrip('/')}/api/v1", timeout=timeout_s)

    def state(self) -> wire.State:
        """Everything at this moment."""
        return wire.State.model_validate(self._ask("GET", "/state"))

    def states(self) -> Iterator[wire.State]:
        """States as they come, about 30 a second; ends when the server does."""
        yield from (message for message in self.messages() if isinstance(message, wire.State))

    def messages(self) -> Iterator[wire.Hello | wire.State | wire.EventMessage | wire.ErrorMessage]:
        """All text messages of the stream; a slow reader misses states, never events."""
        try:
            with connect(self._stream_url, max_size=None) as socket:
                socket.send(_NO_PICTURES)
                for message in socket:
                    if isinstance(message, str):
                        yield _SERVER_MESSAGE.validate_json(message)
        except ConnectionClosed:
            return
        except OSError as error:
            raise ServerError(f"no server at {self._stream_url} ({error}); start it with 'teleop serve'") from error

    def engage(self) -> None:
        """Take the person who is seen as the operator."""
        self._ask("POST", "/engage")

    def disengage(self) -> None:
        """Nobody is in control any more."""
        self._ask("POST", "/disengage")

    def estop(self) -> None:
        """Stop everything until :meth:`estop_reset`."""
        self._ask("POST", "/estop")

    def estop_reset(self) -> None:
        """Release the emergency stop."""
        self._ask("POST", "/estop/reset")

    def command(self, **wanted: Any) -> None:
        """Direct control; keywords as in server.api.operate.RobotAsk (lift_m=..., drive_m_s=...)."""
        self._ask("POST", "/robot/command", json=RobotAsk(**wanted).model_dump(exclude_unset=True))

    def config(self) -> dict[str, Any]:
        """Every setting in force."""
        return dict(self._ask("GET", "/config"))

    def configure(self, patch: Mapping[str, Any]) -> dict[str, Any]:
        """Lay a partial tree over the settings."""
        return dict(self._ask("PATCH", "/config", json=dict(patch)))

    def open(self, source: str, *, loop: bool = False, record: bool = False) -> SessionState:
        """Play a recording of the library, or read a live source."""
        body = {"source": source, "loop": loop, "record": record}
        return SessionState.model_validate(self._ask("POST", "/sessions", json=body))

    def sessions(self) -> list[SessionState]:
        """Running and finished sessions, oldest first."""
        return [SessionState.model_validate(item) for item in self._ask("GET", "/sessions")]

    def close_session(self, session_id: str) -> None:
        """End a session."""
        self._ask("DELETE", f"/sessions/{session_id}")

    def play(self) -> ReplayState:
        """Go on with the replay."""
        return self._replay("play")

    def pause(self) -> ReplayState:
        """Hold the replay."""
        return self._replay("pause")

    def seek(self, position_s: float) -> ReplayState:
        """Jump to a position [s]."""
        return self._replay("seek", {"position_s": position_s})

    def speed(self, speed: float) -> ReplayState:
        """Play slower or faster; 1 is real time."""
        return self._replay("speed", {"speed": speed})

    def loop(self, loop: bool) -> ReplayState:
        """Begin again at the end, or stop there."""
        return self._replay("loop", {"loop": loop})

    def recordings(self) -> list[Recording]:
        """The library."""
        return [Recording.model_validate(item) for item in self._ask("GET", "/recordings")]

    def upload(self, path: Path) -> Recording:
        """Add a recording to the library under its file name."""
        with path.open("rb") as file:
            return Recording.model_validate(self._ask("POST", "/recordings", files={"file": (path.name, file)}))

    def download(self, recording_id: str, path: Path) -> None:
        """Fetch a recording."""
        with self._http.stream("GET", f"/recordings/{recording_id}") as response:
            if response.is_error:
                response.read()
                raise _refusal(response)
            with path.open("wb") as file:
                for chunk in response.iter_bytes():
                    file.write(chunk)

    def delete_recording(self, recording_id: str) -> None:
        """Remove an own recording."""
        self._ask("DELETE", f"/recordings/{recording_id}")

    def urdf(self) -> str:
        """The robot's description."""
        return str(self._send("GET", "/robot/urdf").text)

    def head_jpeg(self) -> bytes:
        """What the head camera sees."""
        return self._send("GET", "/camera/head.jpg").content

    def close(self) -> None:
        """Close the connection."""
        self._http.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _replay(self, action: str, body: Mapping[str, float] | None = None) -> ReplayState:
        return ReplayState.model_validate(self._ask("POST", f"/replay/{action}", json=body))

    def _ask(self, method: str, path: str, **given: Any) -> Any:
        response = self._send(method, path, **given)
        return response.json() if response.content else None

    def _send(self, method: str, path: str, **given: Any) -> httpx.Response:
        try:
            response = self._http.request(method, path, **given)
        except httpx.TransportError as error:
            raise ServerError(
                f"no answer from {self._http.base_url} ({error}); start it with 'teleop serve'"
            ) from error
        if response.is_error:
            raise _refusal(response)
        return response


def _refusal(response: httpx.Response) -> Refused:
    """The server's own words; its status line when an intermediary answered."""
    if response.headers.get("content-type", "").startswith("application/problem+json"):
        return Refused(response.status_code, str(response.json()["detail"]))
    return Refused(response.status_code, f"{response.status_code} {response.reason_phrase}")
