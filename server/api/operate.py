"""Engage, disengage, emergency stop, direct control of the robot, its description and its head camera."""

from __future__ import annotations

from math import degrees

from fastapi import APIRouter, Response
from pydantic import BaseModel, ConfigDict, Field

from robot_sim.commands import ArmTarget
from robot_sim.config import RobotConfig
from server.api.deps import EngineDep, done
from server.api.problems import documented
from server.errors import Refused
from server.wire import Liquid
from teleop.inputs import RobotRequest

router = APIRouter(tags=["robot"])
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
        from robot_sim.commands import Liquid as RobotLiquid

        plain = self.model_dump(exclude={"for_s", "right_arm", "left_arm", "rear_arm", "liquid"})
        arms = {
            name: ask.target() if (ask := getattr(self, name)) else None
            for name in ("right_arm", "left_arm", "rear_arm")
        }
        return RobotRequest(**plain, **arms, liquid=RobotLiquid(self.liquid) if self.liquid else None)


@router.post("/engage", responses=documented(409, 503))
async def engage(engine: EngineDep) -> Accepted:
    """Take the person who is seen as the operator."""
    if engine.session is None:
        raise Refused(409, "there is no source, so nobody to engage; open one with POST /api/v1/sessions")
    await done(engine.engage(True))
    return Accepted()


@router.post("/disengage", responses=documented(503))
async def disengage(engine: EngineDep) -> Accepted:
    """Nobody is in control any more; the robot holds."""
    await done(engine.engage(False))
    return Accepted()


@router.post("/estop", responses=documented(503))
async def estop(engine: EngineDep) -> Accepted:
    """Stop everything and stay stopped until reset. Asking twice does no harm."""
    await done(engine.estop(True))
    return Accepted()


@router.post("/estop/reset", responses=documented(503))
async def reset_estop(engine: EngineDep) -> Accepted:
    """Release the emergency stop; the operator must engage again."""
    await done(engine.estop(False))
    return Accepted()


@router.post("/robot/command", responses=documented(422, 503))
async def command_robot(engine: EngineDep, ask: RobotAsk) -> Accepted:
    """Direct control, through the same safety kernel and limits as the operator's."""
    ask.check(engine.settings.robot)
    await done(engine.ask(ask.request(), ask.for_s))
    return Accepted()


@router.get("/robot/urdf", response_class=Response, responses={200: {"content": {"application/xml": {}}}})
def read_urdf(engine: EngineDep) -> Response:
    """The robot's URDF, primitives only."""
    return Response(engine.urdf, media_type="application/xml")


@router.get("/camera/head.jpg", response_class=Response, responses={200: {"content": {"image/jpeg": {}}}})
async def head_picture(engine: EngineDep) -> Response:
    """What the robot's head camera sees now."""
    return Response(await done(engine.head_jpeg()), media_type="image/jpeg", headers={"Cache-Control": "no-store"})
