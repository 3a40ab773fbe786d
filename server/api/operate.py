"""Engage, disengage, emergency stop, direct control of the robot, its description and its head camera."""

from __future__ import annotations

from fastapi import APIRouter, Response

from server.api.deps import EngineDep, done
from server.api.models import Accepted, RobotAsk
from server.api.problems import documented
from server.errors import Refused

router = APIRouter(tags=["robot"])


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
