"""Requests of the console and the API between two steps, gathered into one teleop Inputs."""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace

from teleop.inputs import Inputs, PickAsk, RobotRequest

_SPEEDS = ("drive_m_s", "turn_rad_s")


@dataclass
class Pending:
    """Belongs to the engine's thread. An e-stop wins over everything asked in the same step; its reset then waits."""

    engage: bool = False
    disengage: bool = False
    estop: bool = False
    estop_reset: bool = False
    request: RobotRequest = field(default_factory=RobotRequest)
    speeds_until_s: float = 0.0
    picks: tuple[PickAsk, ...] = ()

    def ask(self, request: RobotRequest, speeds_until_s: float) -> None:
        """Lay a request over those that wait; its speeds are repeated until then, everything else counts once."""
        given = {f.name: v for f in fields(request) if (v := getattr(request, f.name)) is not None}
        self.request = replace(self.request, **given)
        if any(name in given for name in _SPEEDS):
            self.speeds_until_s = speeds_until_s

    def take(self, now_s: float, receive_t_ns: int | None) -> Inputs:
        """Everything the next frame's step is told."""
        inputs = replace(
            self.take_stop(),
            engage=self.engage,
            disengage=self.disengage,
            request=self.take_request(now_s),
            picks=self.take_picks(),
            receive_t_ns=receive_t_ns,
        )
        self.engage = self.disengage = False
        return inputs

    def take_stop(self) -> Inputs:
        """The e-stop or its reset, which count without a frame, too."""
        stop = Inputs(estop=self.estop, estop_reset=self.estop_reset and not self.estop)
        self.estop, self.estop_reset = False, self.estop and self.estop_reset
        return stop

    def take_picks(self) -> tuple[PickAsk, ...]:
        """What is asked of the assisted pick, in order."""
        picks, self.picks = self.picks, ()
        return picks

    def take_request(self, now_s: float) -> RobotRequest | None:
        """What is asked of the robot now; keeps only speeds that are still wanted."""
        request = self.request
        if now_s >= self.speeds_until_s:
            request = replace(request, drive_m_s=None, turn_rad_s=None)
        self.request = RobotRequest(drive_m_s=request.drive_m_s, turn_rad_s=request.turn_rad_s)
        return None if request == RobotRequest() else request
