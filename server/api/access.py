"""Who am I, login, and the operator lease."""

from __future__ import annotations

import time

from fastapi import APIRouter, Response
from pydantic import BaseModel, ConfigDict, Field
from starlette.requests import Request

from server import wire
from server.api.deps import CallerDep, DeskDep, OptionalCallerDep
from server.api.problems import documented

router = APIRouter(tags=["access"])
_DAY_S = 86_400


class Login(BaseModel):
    """The token of a role, as shown at the server's first start."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"examples": [{"token": "gt_operator_..."}]})
    token: str = Field(min_length=1, max_length=200)


class LeaseTo(BaseModel):
    """Whom the decision is about."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"examples": [{"to": "3fa2b1c09d"}]})
    to: str = Field(min_length=1, max_length=40, description="Party.id of one who asks for the lease")


@router.get("/access")
async def read_access(desk: DeskDep, caller: OptionalCallerDep) -> wire.Access:
    """Who you are here and who commands; ``you`` is null when a token is needed."""
    return desk.access(caller)


@router.post("/login", responses=documented(401, 429))
async def login(desk: DeskDep, request: Request, response: Response, ask: Login) -> wire.Access:
    """Exchange a token for a cookie, so that a browser is known by it; the websocket, too."""
    role = desk.login(ask.token, request.client.host if request.client else "")
    age_s = round(desk.config.login_days * _DAY_S)
    response.set_cookie(
        desk.cookie_name,
        desk.tokens.cookie(role, time.time() + age_s),
        max_age=age_s,
        httponly=True,
        samesite="strict",
        secure=request.url.scheme == "https",
    )
    caller = desk.as_role(request.scope, role)
    desk.note("login", str(caller))
    return desk.access(caller)


@router.post("/logout", status_code=204)
async def logout(desk: DeskDep, response: Response) -> None:
    """Forget the cookie."""
    response.delete_cookie(desk.cookie_name, httponly=True, samesite="strict")


@router.post("/lease/request", responses=documented(422))
async def request_lease(desk: DeskDep, caller: CallerDep) -> wire.Access:
    """Ask to command: granted at once while nobody does, else the holder decides. Asking twice does no harm."""
    desk.request(caller)
    return desk.access(caller)


@router.post("/lease/release")
async def release_lease(desk: DeskDep, caller: CallerDep) -> wire.Access:
    """Give the lease up, or withdraw your request. The oldest request is granted."""
    desk.release(caller)
    return desk.access(caller)


@router.post("/lease/grant", responses=documented(404, 422, 423))
async def grant_lease(desk: DeskDep, caller: CallerDep, ask: LeaseTo) -> wire.Access:
    """Hand the lease over to one who asks for it."""
    desk.grant(caller, ask.to)
    return desk.access(caller)


@router.post("/lease/deny", responses=documented(404, 422, 423))
async def deny_lease(desk: DeskDep, caller: CallerDep, ask: LeaseTo) -> wire.Access:
    """Turn a request down."""
    desk.deny(caller, ask.to)
    return desk.access(caller)


@router.post("/lease/take", responses=documented(422))
async def take_lease(desk: DeskDep, caller: CallerDep) -> wire.Access:
    """A supervisor takes the lease over at once; the operator is disengaged and the robot holds."""
    desk.take(caller)
    return desk.access(caller)
