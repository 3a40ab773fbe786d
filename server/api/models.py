"""What requests and answers of the API hold, apart from the wire's messages. Light to import: the client needs it."""

from __future__ import annotations

from math import degrees
from typing import TYPE_CHECKING, Literal

from pydantic import BaseModel, ConfigDict, Field

from robot_sim.commands import ArmTarget
from robot_sim.commands import Liquid as RobotLiquid
from server.errors import Refused
from server.wire import FruitInfo, Liquid
from teleop.inputs import RobotRequest

if TYPE_CHECKING:
    from robot_sim.config import RobotConfig

_ROUNDING = 1e-3
"""A range that the refusal rounds to six digits includes its own ends."""


class Accepted(BaseModel):
    """The request reached the engine; whether it was followed shows in the state and in an event."""

    accepted: bool = True


class ArmAsk(BaseModel):
    """Servo angles of one arm, as robot_sim.commands.ArmTarget takes them."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)
    c1_deg: float = Field(ge=-180.0, le=180.0, description="shoulder axis C1, forward positive [deg]")
    c2_deg: float = Field(ge=-180.0, le=180.0, description="shoulder axis C2, outward positive [deg]")
    elbow_deg: float = Field(ge=0.0, le=180.0, description="inner elbow angle, 180 straight [deg]")

    def target(self) -> ArmTarget:
        """As the robot takes it."""
        return ArmTarget(self.c1_deg, self.c2_deg, self.elbow_deg)


class RobotAsk(BaseModel):
    """What is asked of the robot; what is left out stays as it is. Arms, chassis and tools only while no operator is
    engaged; lift and disc at any time but under emergency stop."""

    model_config = ConfigDict(
        extra="forbid",
        allow_inf_nan=False,
        json_schema_extra={"examples": [{"lift_m": 0.25}, {"drive_m_s": 0.2, "for_s": 0.5}]},
    )
    lift_m: float | None = Field(None, ge=0.0, le=1.0, description="height of the lift [m]")
    disc_rad: float | None = Field(None, ge=-3.2, le=3.2, description="angle of the disc [rad]")
    drive_m_s: float | None = Field(None, ge=-2.0, le=2.0, description="chassis speed, forward positive [m/s]")
    turn_rad_s: float | None = Field(None, ge=-3.0, le=3.0, description="turning rate, left positive [rad/s]")
    for_s: float = Field(0.25, ge=0.0, le=1.0, description="how long the speeds last; repeat the request to go on [s]")
    right_arm: ArmAsk | None = None
    left_arm: ArmAsk | None = None
    rear_arm: ArmAsk | None = None
    gripper_open: bool | None = None
    cutter_closed: bool | None = None
    spray_on: bool | None = None
    liquid: Liquid | None = None
    head_camera_sweep: bool | None = None

    def check(self, robot: RobotConfig) -> None:
        """Raises Refused (422) with the legal range for what this robot cannot reach."""
        body, arm = robot.body, robot.arm
        legal = {"lift_m": (body.lift.lower, body.lift.upper), "disc_rad": (body.disc.lower, body.disc.upper)}
        given = {name: value for name in legal if (value := getattr(self, name)) is not None}
        for side in ("right_arm", "left_arm", "rear_arm"):
            ask: ArmAsk | None = getattr(self, side)
            if ask is not None:
                for angle in ("c1_deg", "c2_deg"):
                    axis = arm.c1 if angle == "c1_deg" else arm.c2
                    legal[f"{side}.{angle}"] = degrees(axis.lower), degrees(axis.upper)
                    given[f"{side}.{angle}"] = getattr(ask, angle)
                # the servo counts its bend from straight, the request the inner angle
                legal[f"{side}.elbow_deg"] = 180.0 - degrees(arm.elbow.upper), 180.0 - degrees(arm.elbow.lower)
                given[f"{side}.elbow_deg"] = ask.elbow_deg
        beyond = [
            f"{name}: {value:g} is out of range; legal: {legal[name][0]:g} <= {name} <= {legal[name][1]:g}"
            for name, value in given.items()
            if not legal[name][0] - _ROUNDING <= value <= legal[name][1] + _ROUNDING
        ]
        if beyond:
            raise Refused(422, "; ".join(beyond))

    def request(self) -> RobotRequest:
        """As the pipeline takes it."""
        plain = self.model_dump(exclude={"for_s", "right_arm", "left_arm", "rear_arm", "liquid"})
        arms = {
            name: ask.target() if (ask := getattr(self, name)) else None
            for name in ("right_arm", "left_arm", "rear_arm")
        }
        return RobotRequest(**plain, **arms, liquid=RobotLiquid(self.liquid) if self.liquid else None)


class PickOrder(BaseModel):
    """Which fruit to pick, and whether to look at the path first."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"examples": [{}, {"fruit": "cucumber_2_fruit_0", "preview": True}]}
    )
    fruit: str | None = Field(
        None, min_length=1, max_length=80, description="name of a fruit (GET /fruits); null: the nearest ripe one"
    )
    preview: bool = Field(
        False,
        description="show the path and wait to be confirmed; while an operator is engaged it always waits for their "
        "left fist",
    )


class FruitState(FruitInfo):
    """A fruit and what became of it: hanging, held, loose, boxed or dropped; damaged when it is bruised."""

    status: str
    damaged: bool


class ReplayState(BaseModel):
    """Where the replay stands."""

    paused: bool
    ended: bool
    position_s: float
    speed: float
    loop: bool


class Recording(BaseModel):
    """One recording of the library. uri: what POST /sessions takes as its source."""

    id: str
    name: str
    uri: str
    bundled: bool
    size_bytes: int
    modified: float = Field(description="Unix time [s]")
    duration_s: float | None = Field(description="null when the file cannot be read")


class StoryEvent(BaseModel):
    """An event of the recorded session. position_s: seconds after the first frame [s]."""

    position_s: float
    kind: str
    reason: str
    detail: str = ""


class StoryMode(BaseModel):
    """From a position on, until the next one: the operator's mode."""

    position_s: float
    mode: str


class Story(BaseModel):
    """What a recording says happened; empty where only frames were recorded."""

    duration_s: float
    events: list[StoryEvent] = Field(description="oldest first; evenly thinned out beyond a thousand")
    modes: list[StoryMode] = Field(description="changes of the mode, oldest first")


class SessionAsk(BaseModel):
    """What to read."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"examples": [{"source": "greenhouse_demo", "loop": True, "record": False}]}
    )
    source: str = Field(
        min_length=1,
        max_length=500,
        description="name of a recording in the library, or a live source (openni2:, freenect:, realsense:, orbbec:, "
        "virtual:)",
    )
    loop: bool = Field(False, description="start a recording again at its end")
    record: bool = Field(False, description="record the session to the library")


class SessionState(BaseModel):
    """One session, running or finished. Times are Unix times [s]."""

    id: str
    source: str
    kind: str
    live: bool
    running: bool
    started: float
    ended: float | None
    duration_s: float | None
    recording: str | None = Field(description="name of the recording being or having been made")
    fault: str | None


class VirtualArm(BaseModel):
    """How an arm of the rendered operator is held."""

    side_deg: float = Field(description="upper arm raised to the side, theta1 [deg]")
    front_deg: float = Field(description="upper arm raised to the front, theta2 [deg]")
    elbow_deg: float = Field(description="inner angle of the elbow, 180 straight, theta3 [deg]")
    hand: Literal["open", "relaxed", "fist"]


class VirtualOperator(BaseModel):
    """What the rendered operator of ``virtual:live`` is told to do; the state tells where they are seen."""

    x_m: float = Field(description="place on the floor, operator's right positive [m]")
    z_m: float = Field(description="distance from the sensor [m]")
    turn_deg: float = Field(description="turned to the operator's left [deg]")
    apart_deg: float = Field(description="angle between the thighs, T1 [deg]")
    right: VirtualArm
    left: VirtualArm
    gesture: Literal["none", "engage", "stop"] = Field(description="both arms: hands beside the head, forearms crossed")


class Health(BaseModel):
    """The server is up and its engine steps."""

    status: Literal["ok", "degraded"] = Field("ok", description="degraded: the engine has not stepped for too long")
    version: str
    step_age_s: float = Field(description="time since the last step of the robot [s]")
    source: str | None = Field(description="what is playing")
    fault: str | None = Field(description="why the source gives no frames")
