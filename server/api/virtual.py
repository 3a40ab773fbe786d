"""GET and PATCH /virtual: the rendered operator of ``virtual:live``, driven by the console's sliders or a program."""

from __future__ import annotations

from dataclasses import asdict

from fastapi import APIRouter

from server.api.deps import EngineDep
from server.api.models import VirtualOperator
from server.api.problems import documented
from server.engine.engine import Engine
from server.errors import Refused
from teleop.people.wishes import WishChange
from teleop.sources.virtual_live import LivePuppetSource

router = APIRouter(prefix="/virtual", tags=["virtual operator"], responses=documented(409))


@router.get("")
def read_virtual(engine: EngineDep) -> VirtualOperator:
    """What the rendered operator is told to do."""
    return _told(_source(engine))


@router.patch("", responses=documented(422))
def drive_virtual(engine: EngineDep, change: WishChange) -> VirtualOperator:
    """Tell the rendered operator what to do next; what is left out stays. They get there as a person would."""
    source = _source(engine)
    source.wish = change.of(source.wish)
    return _told(source)


def _source(engine: Engine) -> LivePuppetSource:
    session = engine.session
    if session is None or not isinstance(session.source, LivePuppetSource):
        raise Refused(409, "no virtual operator is to be driven; open one with POST /api/v1/sessions (virtual:live)")
    return session.source


def _told(source: LivePuppetSource) -> VirtualOperator:
    return VirtualOperator.model_validate(asdict(source.wish))
