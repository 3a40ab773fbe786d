"""POST /replay/{play|pause|step|seek|speed|loop}: controls of a recorded source."""

from __future__ import annotations

from fastapi import APIRouter
from pydantic import BaseModel, ConfigDict, Field

from server.api.deps import EngineDep
from server.api.models import ReplayState
from server.api.problems import documented
from server.engine.engine import Engine
from server.engine.playback import SPEED_RANGE, Playback
from server.errors import Refused

router = APIRouter(prefix="/replay", tags=["replay"], responses=documented(409))


class Seek(BaseModel):
    """Where to go."""

    model_config = ConfigDict(
        extra="forbid", allow_inf_nan=False, json_schema_extra={"examples": [{"position_s": 12.5}]}
    )
    position_s: float = Field(ge=0.0, description="seconds after the first frame [s]")


class Speed(BaseModel):
    """How fast to play."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, json_schema_extra={"examples": [{"speed": 2.0}]})
    speed: float = Field(ge=SPEED_RANGE[0], le=SPEED_RANGE[1], description="1 is real time")


class Loop(BaseModel):
    """What happens at the end."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"examples": [{"loop": True}]})
    loop: bool = Field(description="begin again at the end")


def _playback(engine: Engine) -> Playback:
    session = engine.session
    if session is None:
        raise Refused(409, "nothing is playing; open a recording with POST /api/v1/sessions")
    if session.info.live:
        raise Refused(409, f"'{session.name}' is a live source; only recordings can be replayed")
    return session.playback


def _state(playback: Playback) -> ReplayState:
    s = playback.state
    return ReplayState(paused=s.paused, ended=s.ended, position_s=s.position_s, speed=s.speed, loop=s.loop)


@router.post("/play")
def replay_play(engine: EngineDep) -> ReplayState:
    """Go on, or from the beginning after the end."""
    playback = _playback(engine)
    playback.play()
    return _state(playback)


@router.post("/pause")
def replay_pause(engine: EngineDep) -> ReplayState:
    """Stand still; the robot is held, then stopped, as when frames stay away."""
    playback = _playback(engine)
    playback.pause()
    return _state(playback)


@router.post("/step")
def step(engine: EngineDep) -> ReplayState:
    """Pause and show the next frame; the robot moves on by one frame's time at most."""
    playback = _playback(engine)
    playback.step()
    return _state(playback)


@router.post("/seek", responses=documented(422))
def replay_seek(engine: EngineDep, ask: Seek) -> ReplayState:
    """Jump; tracking begins anew there and the robot eases to what it sees."""
    playback = _playback(engine)
    playback.seek(ask.position_s)
    return _state(playback)


@router.post("/speed", responses=documented(422))
def replay_speed(engine: EngineDep, ask: Speed) -> ReplayState:
    """Play slower or faster; the robot's time runs along."""
    playback = _playback(engine)
    playback.set_speed(ask.speed)
    return _state(playback)


@router.post("/loop", responses=documented(422))
def replay_loop(engine: EngineDep, ask: Loop) -> ReplayState:
    """Begin again at the end, or stop there."""
    playback = _playback(engine)
    playback.set_loop(ask.loop)
    return _state(playback)
