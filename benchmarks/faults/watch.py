"""A client of the stream: every state and event with the time it came, and whether the robot kept its limits."""

from __future__ import annotations

import json
import threading
import time
from dataclasses import dataclass, field
from types import TracebackType
from typing import Any, Self

from websockets.sync.client import ClientConnection, connect

from robot_sim.actuators import axes
from robot_sim.config import RobotConfig

State = dict[str, Any]
ARMS = ("right_arm", "left_arm", "rear_arm")


def commanded_still(state: State) -> bool:
    """Whether the command moves nothing."""
    c = state["command"]
    return c["drive_m_s"] == c["turn_rad_s"] == 0.0 and not c["spray_on"] and all(c[arm] is None for arm in ARMS)


@dataclass
class Limits:
    """Worst share of a limit that was used: 1 is the limit itself."""

    speed: float = 0.0
    range_rad: float = 0.0
    chassis: float = 0.0


@dataclass
class Watch:
    """Reads the stream in a thread of its own."""

    url: str
    robot: RobotConfig
    states: list[tuple[float, State]] = field(default_factory=list)
    events: list[tuple[float, State]] = field(default_factory=list)
    limits: Limits = field(default_factory=Limits)

    def __enter__(self) -> Self:
        for _ in range(100):
            try:
                self._socket: ClientConnection = connect(self.url, max_size=None)
                break
            except OSError:
                time.sleep(0.05)
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *_: type[BaseException] | BaseException | TracebackType | None) -> None:
        self._socket.close()
        self._thread.join(2.0)

    @property
    def last(self) -> State | None:
        """The newest state."""
        return self.states[-1][1] if self.states else None

    def since(self, t_s: float) -> list[tuple[float, State]]:
        """States that came after a time."""
        return [(t, s) for t, s in list(self.states) if t > t_s]

    def codes_since(self, t_s: float) -> tuple[str, ...]:
        """Reasons of events that came after a time, in order."""
        return tuple(dict.fromkeys(e["reason"] for t, e in list(self.events) if t > t_s))

    def _read(self) -> None:
        for text in self._socket:
            if isinstance(text, bytes):
                continue
            now_s, message = time.monotonic(), json.loads(text)
            if message["type"] == "event":
                self.events.append((now_s, message))
            elif message["type"] == "state":
                if self.states:
                    self._check(self.states[-1][1]["robot"], message["robot"])
                self.states.append((now_s, message))

    def _check(self, old: State, new: State) -> None:
        dt_s = new["sim_time_s"] - old["sim_time_s"]
        chassis = self.robot.chassis
        used = max(abs(new["drive_m_s"]) / chassis.drive_m_s, abs(new["turn_rad_s"]) / chassis.turn_rad_s)
        self.limits.chassis = max(self.limits.chassis, used)
        for axis in axes(self.robot):
            q, before = new["joints"][axis.name], old["joints"][axis.name]
            outside = max(axis.limits.lower - q, q - axis.limits.upper, 0.0)
            self.limits.range_rad = max(self.limits.range_rad, outside)
            if dt_s > 0.01:
                self.limits.speed = max(self.limits.speed, abs(q - before) / dt_s / axis.limits.speed)
