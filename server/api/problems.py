"""Errors as problem details (RFC 9457): one JSON object with type, title, status and detail."""

from __future__ import annotations

import math
from collections.abc import Mapping
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI, Request
from fastapi.encoders import jsonable_encoder
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from pydantic import BaseModel, Field
from starlette.exceptions import HTTPException

from robot_sim.errors import RobotError
from server.access.desk import TooOften
from server.errors import Refused, SettingsError
from teleop.errors import TeleopError

MEDIA_TYPE = "application/problem+json"


class Problem(BaseModel):
    """Why a request was refused or failed."""

    type: str = Field("about:blank", description="about:blank: the status says it all")
    title: str = Field(description="name of the status")
    status: int = Field(description="HTTP status")
    detail: str = Field(description="what is wrong, what is legal, what to do next")
    code: str | None = Field(None, description="which rule, for programs: token, role, origin, host, size, lease, rate")
    errors: list[dict[str, Any]] | None = Field(None, description="each refused field, when the body was wrong")


def problem(
    status: int,
    detail: str,
    errors: list[dict[str, Any]] | None = None,
    *,
    code: str | None = None,
    headers: Mapping[str, str] | None = None,
) -> JSONResponse:
    """A problem-details response."""
    title = HTTPStatus(status).phrase
    body = Problem(type="about:blank", title=title, status=status, detail=detail, code=code, errors=errors)
    return JSONResponse(body.model_dump(exclude_none=True), status, dict(headers or {}), media_type=MEDIA_TYPE)


def refusal(error: Refused) -> JSONResponse:
    """The problem details of a refusal, with the headers that belong to its status."""
    headers = {}
    if error.status == 401:
        headers["WWW-Authenticate"] = "Bearer"
    if isinstance(error, TooOften):
        headers["Retry-After"] = str(max(1, math.ceil(error.wait_s)))
    return problem(error.status, error.detail, code=error.code, headers=headers)


def documented(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """The ``responses`` of a route in the OpenAPI document."""
    schema = {"schema": {"$ref": "#/components/schemas/Problem"}}
    return {
        status: {"description": HTTPStatus(status).phrase, "model": Problem, "content": {MEDIA_TYPE: schema}}
        for status in statuses
    }


def install(app: FastAPI) -> None:
    """Every refusal of ours, and FastAPI's own, leave as problem details."""

    @app.exception_handler(Refused)
    async def _refused(_: Request, error: Refused) -> JSONResponse:
        return refusal(error)

    @app.exception_handler(SettingsError)
    async def _settings(_: Request, error: SettingsError) -> JSONResponse:
        return problem(422, str(error))

    @app.exception_handler(TeleopError)
    @app.exception_handler(RobotError)
    async def _domain(_: Request, error: Exception) -> JSONResponse:
        return problem(409, str(error))

    @app.exception_handler(HTTPException)
    async def _http(_: Request, error: HTTPException) -> JSONResponse:
        response = problem(error.status_code, str(error.detail))
        response.headers.update(error.headers or {})
        return response

    @app.exception_handler(RequestValidationError)
    async def _body(_: Request, error: RequestValidationError) -> JSONResponse:
        items = jsonable_encoder([{k: v for k, v in e.items() if k in ("loc", "msg", "type")} for e in error.errors()])
        text = "; ".join(f"{'.'.join(str(p) for p in e['loc'][1:]) or e['loc'][0]}: {e['msg']}" for e in items)
        return problem(422, text, items)
